// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <deal.II/base/mpi.h>

#include <axiforge/state/fill.h>

namespace axiforge
{
  namespace MPI = dealii::Utilities::MPI;

  double volume_within(const State &state, const double radius)
  {
    // By Gauss' theorem the integral of pi min(r, R)^2 dz round the outline, the body on the left.
    constexpr unsigned int parts     = 8; // for edges that cross the radius
    const double           gauss[3]  = { 0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15) };
    const double           weight[3] = { 5. / 18, 8. / 18, 5. / 18 };
    double                 volume    = 0;
    for (const BoundaryEdge &edge : state.tables.edges)
      {
        if (!edge.owned)
          continue;
        Point x[3];
        for (unsigned int a = 0; a < 3; ++a)
          x[a] = state.node_position(edge.nodes[a]);
        double sum = 0;
        for (unsigned int part = 0; part < parts; ++part)
          for (unsigned int q = 0; q < 3; ++q)
            {
              const double t = (part + gauss[q]) / parts;
              const double r = (1 - t) * (1 - 2 * t) * x[0][0] + t * (2 * t - 1) * x[1][0] +
                               4 * t * (1 - t) * x[2][0];
              const double slope =
                  (4 * t - 3) * x[0][1] + (4 * t - 1) * x[1][1] + (4 - 8 * t) * x[2][1];
              const double inner = std::min(r, radius);
              sum += weight[q] / parts * M_PI * inner * inner * slope;
            }
        // The table runs upwards and to the right.
        volume += edge.side == 0 || edge.side == 3 ? -sum : sum;
      }
    return MPI::sum(volume, state.communicator);
  }


  namespace
  {
    constexpr unsigned int n    = 4000; // columns
    constexpr double       none = std::numeric_limits<double>::infinity();

    struct Columns
    {
      std::vector<double> floor, ceiling; ///< [mm]; infinite where no tool bounds the column
    };


    Columns columns_within(const scene::Scene &scene,
                           const State        &state,
                           const double        radius,
                           const double        time)
    {
      double low = none, high = -none; // of the symmetry line
      for (const BoundaryNode &node : state.tables.boundary_nodes)
        if (node.on_symmetry && std::abs(node.symmetry_normal[1]) > 0.99)
          {
            low  = std::min(low, state.node_position(node.node)[1]);
            high = std::max(high, state.node_position(node.node)[1]);
          }
      low  = MPI::min(low, state.communicator);
      high = MPI::max(high, state.communicator);

      double lowest = none, highest = -none;
      for (const BoundaryNode &node : state.tables.boundary_nodes)
        {
          lowest  = std::min(lowest, state.node_position(node.node)[1]);
          highest = std::max(highest, state.node_position(node.node)[1]);
        }
      const double middle =
          0.5 * (MPI::min(lowest, state.communicator) + MPI::max(highest, state.communicator));
      const bool has_symmetry = low <= high, below = has_symmetry && low < middle;

      std::vector<double> floor(n, has_symmetry && below ? low : -none),
          ceiling(n, has_symmetry && !below ? high : none);
      const double width = radius / n;
      for (const scene::Tool &tool : scene.tools)
        {
          const Vector2 shift = tool.motion.displacement(time);
          for (const std::vector<Point> &line : tool.profile.sample(1e-5 * scene.size))
            for (unsigned int i = 0; i + 1 < line.size(); ++i)
              {
                const Point a = line[i] + shift, b = line[i + 1] + shift;
                // The workpiece's side is on the left: what runs outwards looks up.
                const bool         looks_up = b[0] > a[0];
                const double       from = std::min(a[0], b[0]), to = std::max(a[0], b[0]);
                const unsigned int first = static_cast<unsigned int>(
                    std::clamp(std::ceil(from / width - 0.5), 0., static_cast<double>(n)));
                for (unsigned int k = first; k < n && (k + 0.5) * width <= to; ++k)
                  {
                    const double z =
                        a[1] + ((k + 0.5) * width - a[0]) / (b[0] - a[0]) * (b[1] - a[1]);
                    if (looks_up)
                      floor[k] = std::max(floor[k], z);
                    else
                      ceiling[k] = std::min(ceiling[k], z);
                  }
              }
        }
      return { floor, ceiling };
    }
  } // namespace


  double cavity_within(const scene::Scene &scene,
                       const State        &state,
                       const double        radius,
                       const double        time)
  {
    const Columns columns = columns_within(scene, state, radius, time);
    const double  width   = radius / n;
    double        volume  = 0;
    for (unsigned int k = 0; k < n; ++k)
      if (const double height = columns.ceiling[k] - columns.floor[k];
          height > 0 && std::isfinite(height))
        volume += 2 * M_PI * (k + 0.5) * width * width * height;
    return volume;
  }


  Opening opening_within(const scene::Scene &scene,
                         const State        &state,
                         const double        radius,
                         const double        time)
  {
    const Columns columns = columns_within(scene, state, radius, time);
    const double  width   = radius / n;
    Opening       open;
    unsigned int  count = 0;
    for (unsigned int k = 0; k < n; ++k)
      if (!std::isfinite(columns.ceiling[k] - columns.floor[k]))
        {
          if (count++ == 0)
            open.from = k * width;
          open.to = (k + 1) * width;
        }
    // A column or two at the end of a profile are rounding.
    return count > n / 500 ? open : Opening();
  }


  double fill_fraction(const scene::Scene &scene,
                       const State        &state,
                       const double        radius,
                       const double        time)
  {
    const double cavity = cavity_within(scene, state, radius, time);
    return cavity > 0 ? volume_within(state, radius) / cavity : 0;
  }
} // namespace axiforge
