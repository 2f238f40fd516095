// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

namespace axiforge::laws
{
  /// The flow stress at one point, with its derivatives.
  struct FlowStress
  {
    double value;         // sigma [MPa]
    double d_strain;      // d sigma / d strain [MPa]
    double d_strain_rate; // d sigma / d strain rate [MPa s]
  };

  /**
   * A measured flow stress sigma(strain, strain rate) between the nodes of a rectangular table.
   *
   * Along the strain each rate's curve is Fritsch and Butland's monotone cubic (SIAM J. Sci. Stat.
   * Comput. 5 (1984) 300-304); between the curves the same monotone cubic runs in the logarithm of
   * the rate, with the secant as slope at the first and the last rate. The result passes through
   * the table, is C1 inside it (except where neighbouring rate differences change their sign),
   * doesn't overshoot the two nearest curves, and rises with the rate wherever the table does. Two
   * rates give straight lines in the logarithm of the rate, one rate gives a rate-independent
   * stress.
   *
   * Outside the table the stress keeps the value of the nearest edge (derivative 0 in that
   * direction): measured stresses are not prolonged by a guess.
   */
  class FlowStressTable
  {
  public:
    /**
     * @param strains strictly rising, >= 0, at least two
     * @param rates [1/s] strictly rising, > 0, at least one
     * @param stresses [MPa] > 0, row by row: stresses[i * rates.size() + j] at strain i and rate j
     *
     * These are the caller's duty; read() checks them.
     */
    FlowStressTable(std::vector<double>        strains,
                    const std::vector<double> &rates,
                    const std::vector<double> &stresses);

    /**
     * Reads a CSV file. First row: a label (or nothing), then the rates [1/s]; each further row: a
     * strain, then the stresses [MPa] at those rates. Empty lines and comments from # on are
     * skipped. Every fault throws InputError with file and line; @p entry names the entry of the
     * .prm that gave the file.
     */
    static FlowStressTable read(const std::string &file_name, const std::string &entry);

    /// @p strain_rate > 0. Doesn't allocate; one logarithm.
    FlowStress operator()(double strain, double strain_rate) const;

    bool depends_on_strain() const;
    bool depends_on_rate() const;

    /// The largest strain of the table.
    double last_strain() const;

    /// The rates [1/s] between which the table was measured; equal if there is one.
    double lowest_rate() const;
    double highest_rate() const;

  private:
    std::vector<double> strains;
    std::vector<double> log_rates;
    // Curve by curve: [rate * strains.size() + strain].
    std::vector<double> values; // MPa
    std::vector<double> slopes; // MPa, along the strain
  };
} // namespace axiforge::laws
