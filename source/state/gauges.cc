// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <deal.II/base/mpi.h>

#include <axiforge/base/features.h>
#include <axiforge/base/phases.h>
#include <axiforge/state/contact_ends.h>
#include <axiforge/state/gauges.h>

namespace axiforge
{
  namespace
  {
    using scene::Gauge;

    constexpr double none = std::numeric_limits<double>::infinity();

    /// Of the workpiece's size: nodes as near as this to a line stand on it.
    constexpr double on_line = 1e-9;

    /// One coordinate along an edge: value + slope s + curvature s^2, s from -1 to 1.
    struct Parabola
    {
      double value, slope, curvature;

      Parabola(const double start, const double end, const double middle)
          : value(middle)
          , slope(0.5 * (end - start))
          , curvature(0.5 * (start + end) - middle)
      {
      }

      double operator()(const double s) const
      {
        return value + s * (slope + s * curvature);
      }
    };

    Parabola along(const State &state, const BoundaryEdge &edge, const unsigned int component)
    {
      const auto at = [&](const unsigned int a) {
        return state.position.local_element(2 * edge.nodes[a] + component);
      };
      return Parabola(at(0), at(1), at(2));
    }


    /// The smaller of two values, or the larger: both are kept as the smaller, the latter negative.
    class Extreme
    {
    public:
      explicit Extreme(const bool largest)
          : sign(largest ? -1 : 1)
      {
      }

      void add(const double x)
      {
        found = std::min(found, sign * x);
      }

      void add(const Parabola &x, const double from, const double to)
      {
        add(x(from));
        add(x(to));
        const double turn = -0.5 * x.slope / x.curvature;
        if (turn > from && turn < to) // false for a straight line, where it is inf or nan
          add(x(turn));
      }

      double sign, found = none;
    };


    /// Where the parabola has a given value; all of the edge, if it runs along the line.
    void add_cuts(const Parabola &across,
                  const Parabola &x,
                  const double    line,
                  const double    tolerance,
                  Extreme        &extreme)
    {
      const double C = across.value - line, B = across.slope, A = across.curvature;
      const bool   near[3] = { std::abs(across(-1) - line) <= tolerance, std::abs(C) <= tolerance,
                               std::abs(across(1) - line) <= tolerance };
      if (near[0] && near[1] && near[2])
        {
          extreme.add(x, -1, 1);
          return;
        }
      if (near[0])
        extreme.add(x(-1));
      if (near[2])
        extreme.add(x(1));
      const double discriminant = B * B - 4 * A * C;
      if (discriminant < 0)
        return;
      // The root that does not cancel, and the other from the product of both.
      const double q = -0.5 * (B + std::copysign(std::sqrt(discriminant), B));
      for (const double s : { q / A, C / q })
        if (std::abs(s) <= 1) // false for what a straight line leaves undefined
          extreme.add(x(s));
    }


    void add_contact(const State        &state,
                     const BoundaryEdge &edge,
                     const Parabola     &x,
                     const unsigned int  tool,
                     Extreme            &extreme)
    {
      bool touches[3];
      for (unsigned int a = 0; a < 3; ++a)
        {
          const NodeContact &contact = state.contacts[edge.boundary_nodes[a]];
          touches[a]                 = contact.tool[0] == tool || contact.tool[1] == tool;
        }
      constexpr double place[3] = { -1, 1, 0 };
      for (unsigned int a = 0; a < 3; ++a)
        if (touches[a])
          extreme.add(x(place[a]));
      if (touches[2])
        extreme.add(x, touches[0] ? -1 : 0, touches[1] ? 1 : 0);
    }


    /// What touches of an edge past its last node.
    void add_end(const State       &state,
                 const ContactEnd  &end,
                 const unsigned int component,
                 Extreme           &extreme)
    {
      constexpr double place[3] = { -1, 1, 0 };
      const double     from = place[end.last], to = from + end.share * (place[end.next] - from);
      extreme.add(along(state, state.tables.edges[end.edge], component), std::min(from, to),
                  std::max(from, to));
    }


    bool is_surface(const State &state, const BoundaryEdge &edge)
    {
      for (const char *name : { "axis", "symmetry" })
        if (const auto id = state.boundary_ids.find(name);
            id != state.boundary_ids.end() && id->second == edge.id)
          return false;
      return true;
    }


    /// Half way between the smallest and the largest coordinate. Collective.
    double middle_of(const State &state, const unsigned int component)
    {
      Extreme low(false), high(true);
      for (const BoundaryEdge &edge : state.tables.edges)
        if (edge.owned)
          {
            const Parabola x = along(state, edge, component);
            low.add(x, -1, 1);
            high.add(x, -1, 1);
          }
      return 0.5 * (dealii::Utilities::MPI::min(low.found, state.communicator) -
                    dealii::Utilities::MPI::min(high.found, state.communicator));
    }
  } // namespace


  std::vector<double> read_gauges(const scene::Scene &scene, const State &state)
  {
    const std::vector<Gauge> &gauges = scene.gauges;
    if (!optional_features || gauges.empty())
      return {};
    const Phase             phase("gauges");
    std::vector<double>     found;
    std::vector<ContactEnd> ends;
    if (std::any_of(gauges.begin(), gauges.end(),
                    [](const Gauge &gauge) { return gauge.place == Gauge::Place::contact; }))
      ends = contact_ends(scene, state, state.contacts, state.time,
                          [&](const unsigned int node) { return state.node_position(node); });
    for (const Gauge &gauge : gauges)
      {
        const double line = gauge.place == Gauge::Place::middle
                                ? middle_of(state, 1 - gauge.component)
                                : gauge.line;
        Extreme      extreme(gauge.largest);
        for (const BoundaryEdge &edge : state.tables.edges)
          if (edge.owned)
            {
              const Parabola x = along(state, edge, gauge.component);
              if (gauge.place == Gauge::Place::contact)
                add_contact(state, edge, x, gauge.tool, extreme);
              else if (gauge.place != Gauge::Place::surface)
                add_cuts(along(state, edge, 1 - gauge.component), x, line, on_line * state.size,
                         extreme);
              else if (is_surface(state, edge))
                extreme.add(x, -1, 1);
            }
        if (gauge.place == Gauge::Place::contact)
          for (const ContactEnd &end : ends)
            if (end.tool == gauge.tool)
              add_end(state, end, gauge.component, extreme);
        found.push_back(extreme.found);
      }
    std::vector<double> least(found.size());
    dealii::Utilities::MPI::min(found, state.communicator, least);
    for (unsigned int i = 0; i < gauges.size(); ++i)
      least[i] = least[i] == none    ? std::numeric_limits<double>::quiet_NaN()
                 : gauges[i].largest ? -least[i]
                                     : least[i];
    return least;
  }
} // namespace axiforge
