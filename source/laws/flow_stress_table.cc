// SPDX-License-Identifier: GPL-2.0-or-later

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <axiforge/base/csv.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/notes.h>
#include <axiforge/laws/flow_stress_table.h>

namespace axiforge::laws
{
  namespace
  {
    /// Fritsch and Butland's slope at a node between secants a (interval ha) and b (interval hb):
    /// the weighted harmonic mean, 0 at an extremum; with its derivatives by a and b.
    struct MeanSlope
    {
      double value;
      double d_a;
      double d_b;
    };

    MeanSlope mean_slope(const double a, const double ha, const double b, const double hb)
    {
      if (!(a * b > 0.))
        return { 0., 0., 0. };
      const double wa          = 2. * hb + ha;
      const double wb          = hb + 2. * ha;
      const double denominator = wa * b + wb * a;
      const double scale       = (wa + wb) / (denominator * denominator);
      return { (wa + wb) * a * b / denominator, scale * wa * b * b, scale * wb * a * a };
    }

    /// The three-point slope at an end node, limited so that the cubic stays monotone. a, ha: the
    /// end's own interval.
    double end_slope(const double a, const double ha, const double b, const double hb)
    {
      const double slope = a + ha * (a - b) / (ha + hb);
      if (!(slope * a > 0.))
        return 0.;
      return std::abs(slope) > 3. * std::abs(a) ? 3. * a : slope;
    }

    /// Weights of the two values and the two slopes in the cubic on [x0, x1], for its value or its
    /// derivative.
    struct CubicWeights
    {
      double value0, value1, slope0, slope1;

      double apply(const double v0, const double v1, const double s0, const double s1) const
      {
        return value0 * v0 + value1 * v1 + slope0 * s0 + slope1 * s1;
      }
    };

    CubicWeights cubic(const double t, const double h)
    {
      const double s = 1. - t;
      return { s * s * (1. + 2. * t), t * t * (3. - 2. * t), h * t * s * s, -h * t * t * s };
    }

    CubicWeights cubic_derivative(const double t, const double h)
    {
      const double s = 1. - t;
      return { -6. * t * s / h, 6. * t * s / h, s * (1. - 3. * t), t * (3. * t - 2.) };
    }

    /// The place of x in a rising axis of at least two nodes, moved to the nearest edge if outside.
    struct Place
    {
      std::size_t interval;
      double      t;
      double      h;
      bool        inside;
    };

    Place find_place(const std::vector<double> &axis, const double x)
    {
      if (x <= axis.front())
        return { 0, 0., axis[1] - axis[0], x == axis.front() };
      const std::size_t last = axis.size() - 2;
      if (x >= axis.back())
        return { last, 1., axis[last + 1] - axis[last], x == axis.back() };
      const std::size_t i = std::upper_bound(axis.begin(), axis.end(), x) - axis.begin() - 1;
      const double      h = axis[i + 1] - axis[i];
      return { i, (x - axis[i]) / h, h, true };
    }

    /// What a message has to name.
    struct Source
    {
      std::string entry, file;
    };

    [[noreturn]] void fail(const Source &source, const std::string &line, const std::string &what)
    {
      throw InputError::entry(
          source.entry, source.file, line + ": " + what, "",
          "First row: a label, then the strain rates [1/s]; each further row: a "
          "strain, then the stresses [MPa]");
    }

    void check_rising(const Source      &source,
                      const std::string &line,
                      const char        *name,
                      const double       before,
                      const double       value)
    {
      if (value <= before)
        fail(source, line,
             fmt::format("the {} {} does not exceed the one before it, {}. Sort the table so that "
                         "the values rise, each given once",
                         name, value, before));
    }
  } // namespace

  namespace
  {
    /**
     * A number in the corner is either no more than a label, or the first strain of a table whose
     * row of rates is missing. It can be a strain if the next one exceeds it.
     */
    void check_corner(const Source &source, const CsvTable &csv, const std::string &line)
    {
      if (csv.header.empty() && csv.rows.size() > 1 && csv.rows[0][0] < csv.rows[1][0])
        fail(source, line,
             fmt::format("it begins with the number {}, like a row of stresses. If the table has "
                         "no strain rates, put a row \"strain, 1\" before it; if these are the "
                         "rates, write the word strain for that number",
                         csv.rows[0][0]));
    }

    /// Strains in per cent by the words of the corner.
    bool says_per_cent(const CsvTable &csv)
    {
      const std::string label = csv.header.empty() ? "" : csv.header[0];
      return label.find('%') != std::string::npos || label.find("percent") != std::string::npos ||
             label.find("per cent") != std::string::npos;
    }

    /// Stresses and strains that can't be MPa and true strains.
    void check_units(const Source              &source,
                     const CsvTable            &csv,
                     const std::vector<double> &strains,
                     const std::vector<double> &stresses)
    {
      constexpr double no_stress = 1e6; // MPa: five times the modulus of steel
      constexpr double much      = 4.;  // compressed to 2 % of the height
      const double     largest   = *std::max_element(stresses.begin(), stresses.end());
      if (largest >= no_stress)
        fail(source, "stresses",
             fmt::format("{} MPa is no flow stress: it looks like Pa, and is {} MPa then", largest,
                         largest / 1e6));
      if (says_per_cent(csv))
        fail(source, "first row",
             fmt::format("\"{}\" says that the strains are in per cent. Divide them by 100",
                         csv.header[0]));
      if (strains.back() > much)
        note(fmt::format("\"{}\" ends at a strain of {}. If that is in per cent, divide the "
                         "strains by 100.",
                         source.file, strains.back()));
    }
  } // namespace

  FlowStressTable::FlowStressTable(std::vector<double>        strains_,
                                   const std::vector<double> &rates,
                                   const std::vector<double> &stresses)
      : strains(std::move(strains_))
      , values(stresses.size())
      , slopes(stresses.size())
  {
    for (const double rate : rates)
      log_rates.push_back(std::log(rate));

    const std::size_t n = strains.size();
    for (std::size_t j = 0; j < rates.size(); ++j)
      {
        double *v = &values[j * n];
        double *s = &slopes[j * n];
        for (std::size_t i = 0; i < n; ++i)
          v[i] = stresses[i * rates.size() + j];

        const auto width  = [&](const std::size_t i) { return strains[i + 1] - strains[i]; };
        const auto secant = [&](const std::size_t i) { return (v[i + 1] - v[i]) / width(i); };
        if (n == 2)
          s[0] = s[1] = secant(0);
        else
          {
            s[0]     = end_slope(secant(0), width(0), secant(1), width(1));
            s[n - 1] = end_slope(secant(n - 2), width(n - 2), secant(n - 3), width(n - 3));
            for (std::size_t i = 1; i + 1 < n; ++i)
              s[i] = mean_slope(secant(i - 1), width(i - 1), secant(i), width(i)).value;
          }
      }
  }

  FlowStressTable FlowStressTable::read(const std::string &file_name, const std::string &entry)
  {
    const CsvTable csv = read_csv(file_name, entry);
    const Source   source{ entry, file_name };

    // The corner's label decides whether read_csv() takes the first row for a header.
    const bool        has_label = !csv.header.empty();
    const std::string first =
        has_label ? std::string("first row") : fmt::format("line {}", csv.lines.at(0));
    if (csv.columns() < 2)
      fail(source, first, "it must hold a label and then at least one strain rate [1/s]");

    check_corner(source, csv, first);
    std::vector<double> rates;
    for (unsigned int j = 1; j < csv.columns(); ++j)
      {
        double rate = has_label ? 0. : csv.rows[0][j];
        if (has_label && !parse_number(csv.header[j], rate))
          fail(
              source, first,
              fmt::format("\"{}\" is not a strain rate [1/s]: the first row holds a label and then "
                          "the rates",
                          csv.header[j]));
        if (!(rate > 0.))
          fail(source, first, fmt::format("the strain rate {} must be positive", rate));
        if (!rates.empty())
          check_rising(source, first, "strain rate", rates.back(), rate);
        rates.push_back(rate);
      }

    std::vector<double> strains, stresses;
    for (std::size_t i = has_label ? 0 : 1; i < csv.rows.size(); ++i)
      {
        const std::string line   = fmt::format("line {}", csv.lines[i]);
        const double      strain = csv.rows[i][0];
        if (strain < 0.)
          fail(source, line, fmt::format("the strain {} must not be negative", strain));
        if (!strains.empty())
          check_rising(source, line, "strain", strains.back(), strain);
        strains.push_back(strain);
        for (unsigned int j = 1; j < csv.columns(); ++j)
          {
            stresses.push_back(csv.rows[i][j]);
            if (!(stresses.back() > 0.))
              fail(source, line,
                   fmt::format("the stress {} in column {} must be positive", stresses.back(),
                               j + 1));
          }
      }
    if (strains.size() < 2)
      fail(source, "end",
           fmt::format("the table has {} row of stresses, but it needs at least 2 (give the same "
                       "stresses at two strains for a material that does not harden)",
                       strains.size()));
    check_units(source, csv, strains, stresses);
    return FlowStressTable(strains, rates, stresses);
  }

  FlowStress FlowStressTable::operator()(const double strain, const double strain_rate) const
  {
    const std::size_t  n          = strains.size();
    const Place        along      = find_place(strains, strain);
    const CubicWeights weights    = cubic(along.t, along.h);
    const CubicWeights derivative = cubic_derivative(along.t, along.h);

    // Stress and hardening slope of one rate's curve.
    const auto curve = [&](const std::size_t j, double &value, double &slope) {
      const double *v = &values[j * n + along.interval];
      const double *s = &slopes[j * n + along.interval];
      value           = weights.apply(v[0], v[1], s[0], s[1]);
      slope           = along.inside ? derivative.apply(v[0], v[1], s[0], s[1]) : 0.;
    };

    double v0, s0;
    if (log_rates.size() == 1)
      {
        curve(0, v0, s0);
        return { v0, s0, 0. };
      }

    const Place       across = find_place(log_rates, std::log(strain_rate));
    const std::size_t j      = across.interval;
    double            v1, s1;
    curve(j, v0, s0);
    curve(j + 1, v1, s1);

    // Slopes by log(rate) at the interval's two ends, and their derivatives by the strain.
    const double secant   = (v1 - v0) / across.h;
    const double d_secant = (s1 - s0) / across.h;
    double       m0 = secant, d_m0 = d_secant, m1 = secant, d_m1 = d_secant;
    if (j > 0)
      {
        double v, s;
        curve(j - 1, v, s);
        const double    h    = log_rates[j] - log_rates[j - 1];
        const MeanSlope mean = mean_slope((v0 - v) / h, h, secant, across.h);
        m0                   = mean.value;
        d_m0                 = mean.d_a * (s0 - s) / h + mean.d_b * d_secant;
      }
    if (j + 2 < log_rates.size())
      {
        double v, s;
        curve(j + 2, v, s);
        const double    h    = log_rates[j + 2] - log_rates[j + 1];
        const MeanSlope mean = mean_slope(secant, across.h, (v - v1) / h, h);
        m1                   = mean.value;
        d_m1                 = mean.d_a * d_secant + mean.d_b * (s - s1) / h;
      }

    const CubicWeights in_rate = cubic(across.t, across.h);
    const double       by_log_rate =
        across.inside ? cubic_derivative(across.t, across.h).apply(v0, v1, m0, m1) : 0.;
    return { in_rate.apply(v0, v1, m0, m1), in_rate.apply(s0, s1, d_m0, d_m1),
             by_log_rate / strain_rate };
  }

  bool FlowStressTable::depends_on_strain() const
  {
    for (std::size_t k = 0; k < values.size(); ++k)
      if (values[k] != values[k / strains.size() * strains.size()])
        return true;
    return false;
  }

  bool FlowStressTable::depends_on_rate() const
  {
    for (std::size_t k = 0; k < values.size(); ++k)
      if (values[k] != values[k % strains.size()])
        return true;
    return false;
  }

  double FlowStressTable::last_strain() const
  {
    return strains.back();
  }

  double FlowStressTable::lowest_rate() const
  {
    return std::exp(log_rates.front());
  }

  double FlowStressTable::highest_rate() const
  {
    return std::exp(log_rates.back());
  }
} // namespace axiforge::laws
