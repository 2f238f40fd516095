// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <regex>
#include <set>

#include <fmt/format.h>
#include <gmsh.h>

#include <axiforge/base/cad_section.h>
#include <axiforge/base/csv.h>
#include <axiforge/base/errors.h>
#include <axiforge/tools/profile_reader.h>

namespace axiforge::tools
{
  namespace
  {
    /// Shares of the size of a curve.
    constexpr double shape_tolerance  = 1e-9; ///< to be a line or an arc
    constexpr double spline_tolerance = 1e-6; ///< of cubic pieces

    /// One curve of gmsh's model with its parametrisation.
    class Curve
    {
    public:
      Curve(const int tag, const std::string &entry, const std::string &file)
          : tag(tag)
          , entry(entry)
          , file(file)
      {
        std::vector<double> lower, upper;
        gmsh::model::getParametrizationBounds(1, tag, lower, upper);
        begin = lower.at(0);
        end   = upper.at(0);
      }

      Point point(const double u) const
      {
        std::vector<double> x;
        gmsh::model::getValue(1, tag, { u }, x);
        return checked(x);
      }

      Vector2 derivative(const double u) const
      {
        std::vector<double> d;
        gmsh::model::getDerivative(1, tag, { u }, d);
        return Vector2({ d.at(0), d.at(1) });
      }

      /// In the plane, and not on the wrong side of the axis.
      Point checked(const std::vector<double> &x) const
      {
        const double size = std::max({ std::abs(x.at(0)), std::abs(x.at(1)), 1e-3 });
        if (std::abs(x.at(2)) > 1e-6 * size)
          throw InputError::entry(
              entry, file,
              fmt::format("curve {} leaves gmsh's plane z = 0 (z = {:.6g})", tag, x[2]),
              "plane profiles with x = r and y = z");
        if (x[0] < -1e-7 * size)
          throw InputError::entry(
              entry, file,
              fmt::format("curve {} has a point r = {:.6g}, z = {:.6g} mm", tag, x[0], x[1]),
              "radii r >= 0");
        return Point(x[0], x[1]);
      }

      int         tag;
      std::string entry, file;
      double      begin = 0, end = 0; ///< of the parameter
    };

    bool on_axis(const std::vector<Point> &points, const double size)
    {
      return std::all_of(points.begin(), points.end(),
                         [&](const Point &x) { return std::abs(x[0]) <= 1e-9 * size; });
    }

    bool is_straight(const std::vector<Point> &points, const double size)
    {
      const Vector2 d = points.back() - points.front();
      if (d.norm() <= shape_tolerance * size)
        return false;
      double passed = 0; // and not turning back on itself
      for (const Point &x : points)
        {
          const Vector2 e     = x - points.front();
          const double  along = e * d / d.norm();
          if (std::abs(e[0] * d[1] - e[1] * d[0]) > shape_tolerance * size * d.norm() ||
              along < passed - shape_tolerance * size)
            return false;
          passed = along;
        }
      return true;
    }

    /// Centre of the circle through three points, or false if they are on a line.
    bool circle_centre(const Point &a, const Point &b, const Point &c, Point &centre)
    {
      const Vector2 u = b - a, v = c - a;
      const double  determinant = 2 * (u[0] * v[1] - u[1] * v[0]);
      if (std::abs(determinant) <= 1e-6 * u.norm() * v.norm())
        return false;
      const double uu = u * u, vv = v * v;
      centre = a + Vector2({ (v[1] * uu - u[1] * vv) / determinant,
                             (u[0] * vv - v[0] * uu) / determinant });
      return true;
    }

    /// Add the curve as circular arcs of at most half a turn if its points lie on a circle.
    bool
    add_arcs(const std::vector<Point> &points, const double size, std::vector<Segment> &segments)
    {
      const std::size_t n = points.size() - 1;
      Point             centre;
      if (!circle_centre(points[0], points[n / 3], points[(2 * n) / 3], centre))
        return false;
      const double radius = centre.distance(points[0]);
      double       turn   = 0;
      for (std::size_t i = 0; i <= n; ++i)
        {
          if (std::abs(points[i].distance(centre) - radius) > shape_tolerance * size)
            return false;
          if (i == 0)
            continue;
          const Vector2 u = points[i - 1] - centre, v = points[i] - centre;
          turn += std::atan2(u[0] * v[1] - u[1] * v[0], u * v);
        }
      segments.push_back(Segment::arc(points[0], points[n / 2], centre, turn > 0));
      segments.push_back(Segment::arc(points[n / 2], points[n], centre, turn > 0));
      return true;
    }

    void add_cubics(const Curve          &curve,
                    const double          begin,
                    const double          end,
                    const double          tolerance,
                    const unsigned int    depth,
                    std::vector<Segment> &segments)
    {
      const double  width = end - begin;
      const Segment piece =
          Segment::cubic(curve.point(begin), curve.point(end), width * curve.derivative(begin),
                         width * curve.derivative(end));
      double error = 0;
      for (const double t : { 0.2, 0.35, 0.5, 0.65, 0.8 })
        error = std::max(error, piece.point(t).distance(curve.point(begin + t * width)));
      // A tangent may stop in the parameter: pieces have to have a direction at their ends, too.
      const double chord = piece.begin().distance(piece.end());
      if (error <= tolerance && std::isfinite(piece.length()) && piece.length() < 2 * chord &&
          curve.derivative(begin).norm() * width > 1e-6 * chord &&
          curve.derivative(end).norm() * width > 1e-6 * chord)
        segments.push_back(piece);
      else if (depth == 0)
        segments.push_back(Segment::line(piece.begin(), piece.end()));
      else
        {
          const double middle = (begin + end) / 2;
          add_cubics(curve, begin, middle, tolerance, depth - 1, segments);
          add_cubics(curve, middle, end, tolerance, depth - 1, segments);
        }
    }

    void add_curve(const Curve &curve, std::vector<Segment> &segments)
    {
      constexpr unsigned int n_samples = 24;
      std::vector<Point>     points;
      Box                    box;
      for (unsigned int i = 0; i <= n_samples; ++i)
        {
          points.push_back(
              curve.point(curve.begin + (curve.end - curve.begin) * i / double(n_samples)));
          box.add(points.back());
        }

      const double size = box.size();
      if (!(size > 0) || on_axis(points, size))
        return;
      if (is_straight(points, size))
        {
          segments.push_back(Segment::line(points.front(), points.back()));
          return;
        }
      if (add_arcs(points, size, segments))
        return;
      constexpr unsigned int n_first = 4;
      for (unsigned int i = 0; i < n_first; ++i)
        add_cubics(curve, curve.begin + (curve.end - curve.begin) * i / double(n_first),
                   curve.begin + (curve.end - curve.begin) * (i + 1) / double(n_first),
                   spline_tolerance * size,
                   /* depth = */ 20, segments);
    }

    /// The line elements gmsh has on a curve of a `.msh`.
    void add_mesh_lines(const Curve &curve, std::vector<Segment> &segments)
    {
      std::vector<int>                      types;
      std::vector<std::vector<std::size_t>> elements, nodes;
      gmsh::model::mesh::getElements(types, elements, nodes, 1, curve.tag);

      const auto node = [&](const std::size_t tag) {
        std::vector<double> x, parameters;
        gmsh::model::mesh::getNode(tag, x, parameters);
        return curve.checked(x);
      };
      for (std::size_t i = 0; i < types.size(); ++i)
        {
          const std::size_t n =
              nodes[i].size() / elements[i].size(); // the ends, then those between
          for (std::size_t e = 0; e < elements[i].size(); ++e)
            {
              std::vector<Point> points = { node(nodes[i][e * n]) };
              for (std::size_t k = 2; k < n; ++k)
                points.push_back(node(nodes[i][e * n + k]));
              points.push_back(node(nodes[i][e * n + 1]));
              if (on_axis(points, points.front().distance(points.back())))
                continue;
              for (std::size_t k = 1; k < points.size(); ++k)
                segments.push_back(Segment::line(points[k - 1], points[k]));
            }
        }
    }
  } // namespace

  namespace
  {
    /// The name of a column without its unit, in lower case: "r" of "R_mm", "r [mm]", "r (mm)".
    std::string bare_name(const std::string &name, std::string &unit)
    {
      std::string lower;
      for (const char c : name)
        lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      static const std::regex pattern(R"(([a-z]+)[\s_/,]*[\[(]?([a-z"]*)[\])]?)");
      std::smatch             parts;
      if (!std::regex_match(lower, parts, pattern))
        return lower;
      unit = parts[2];
      return parts[1];
    }

    /// The columns of r and z: as the header says, or in that order where there is none.
    std::array<unsigned int, 2> columns_of_profile(const CsvTable &table, const std::string &entry)
    {
      if (table.header.empty())
        return { { 0, 1 } };
      static const std::set<std::string> radial = { "r", "radius", "radial", "x" },
                                         axial  = { "z", "height", "axial", "y" };
      constexpr unsigned int      none          = 2;
      std::array<unsigned int, 2> columns{ { none, none } };
      bool                        in_mm = true;
      for (unsigned int c = 0; c < table.header.size(); ++c)
        {
          std::string       unit;
          const std::string name = bare_name(table.header[c], unit);
          in_mm                  = in_mm && (unit.empty() || unit == "mm");
          if (radial.count(name))
            columns[0] = c;
          else if (axial.count(name))
            columns[1] = c;
        }
      if (!in_mm || columns[0] == none || columns[1] == none)
        throw InputError::entry(
            entry, table.file,
            fmt::format("its header names the columns {}", fmt::join(table.header, ", ")),
            "r_mm and z_mm, in any order, or no header for r and then z in mm");
      return columns;
    }
  } // namespace

  Profile read_profile_csv(const std::string &file, const std::string &section)
  {
    const std::string entry = section + "/Geometry file";
    const CsvTable    table = read_csv(file, entry, 2);
    const auto        wrong = [&](const unsigned int row, const std::string &what) {
      return InputError::entry(entry, file, fmt::format("line {}: {}", table.lines[row], what),
                                      "a polyline with the columns r_mm, z_mm, r >= 0");
    };
    if (table.columns() != 2)
      throw wrong(0, fmt::format("there are {} columns", table.columns()));

    const std::array<unsigned int, 2> columns = columns_of_profile(table, entry);

    std::vector<Point> points;
    Box                box;
    for (unsigned int row = 0; row < table.rows.size(); ++row)
      {
        const Point x(table.rows[row][columns[0]], table.rows[row][columns[1]]);
        if (x[0] < 0)
          throw wrong(row, fmt::format("r = {} is negative", x[0]));
        if (row > 0 && x == points.back())
          throw wrong(row, "the point is the same as the one before");
        points.push_back(x);
        box.add(x);
      }

    std::vector<Segment> segments;
    for (std::size_t i = 1; i < points.size(); ++i)
      if (!on_axis({ points[i - 1], points[i] }, box.size()))
        segments.push_back(Segment::line(points[i - 1], points[i]));
    return Profile(std::move(segments), fmt::format("Entry \"{}\" = \"{}\"", entry, file));
  }

  Profile read_profile_gmsh(const std::string    &file,
                            const std::string    &physical_group,
                            const GeometryValues &parameters,
                            const std::string    &section)
  {
    const std::string entry = section + "/Geometry file";
    GmshSession       session;
    session.open(file, parameters, entry);

    std::vector<int> curves;
    if (session.holds_cad())
      session.run("taking the tool's curves", [&] {
        curves = curves_of_cad([&](const std::string &what, const std::string &way_out) {
          return InputError::entry(entry, file, what, "", way_out);
        });
      });
    else if (physical_group.empty())
      {
        gmsh::vectorpair entities;
        gmsh::model::getEntities(entities, 1);
        for (const auto &entity : entities)
          curves.push_back(entity.second);
      }
    else
      {
        curves = session.entities_of_group(1, physical_group);
        if (curves.empty())
          throw InputError::entry(section + "/Physical group", physical_group,
                                  fmt::format("\"{}\" has no physical curve of this name", file),
                                  fmt::format("the physical curves of this file: {}",
                                              quoted_list(session.group_names(1))),
                                  "An empty name takes all curves");
      }

    std::vector<Segment> segments;
    session.run("taking the tool's curves", [&]() {
      for (const int tag : curves)
        if (session.holds_mesh())
          add_mesh_lines(Curve(tag, entry, file), segments);
        else
          add_curve(Curve(tag, entry, file), segments);
    });
    return Profile(std::move(segments), fmt::format("Entry \"{}\" = \"{}\"", entry, file));
  }

  Profile read_profile(const GeometryParameters &parameters,
                       const std::string        &section,
                       const std::string        &directory)
  {
    if (trim(parameters.file).empty())
      throw InputError::entry(section + "/Geometry file", parameters.file, "a tool needs a profile",
                              "a .geo, .msh, .step, .stp, .brep or .csv file");
    const std::string    file = resolve_path(directory, parameters.file);
    const GeometryValues values =
        parse_geometry_parameters(parameters.parameters, section + "/Geometry parameters");
    if (file.size() > 4 &&
        (file.substr(file.size() - 4) == ".csv" || file.substr(file.size() - 4) == ".CSV"))
      {
        if (!values.empty())
          throw InputError::entry(section + "/Geometry parameters", parameters.parameters,
                                  "a .csv has no parameters",
                                  "an empty entry, or a .geo as Geometry file");
        return read_profile_csv(file, section);
      }
    return read_profile_gmsh(file, parameters.physical_group, values, section);
  }
} // namespace axiforge::tools
