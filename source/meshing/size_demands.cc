// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <axiforge/meshing/size_demands.h>
#include <axiforge/meshing/workpiece_mesh.h>

namespace axiforge::meshing
{
  namespace
  {
    using Samples = std::vector<std::vector<Outline::Sample>>;

    /// Smallest size over the size, unless an entry says so.
    constexpr double smallest_share = 0.1;

    /// Surfaces face each other if their normals enclose more than 120 degrees.
    constexpr double facing = -0.5;


    /// Two tools make a corner that free surface fills if their normals enclose more than 60
    /// degrees.
    constexpr double corner_facing = 0.5;

    /// A corner of a tool is sharp if its sides enclose more than this [rad].
    constexpr double sharp_corner = M_PI / 6;

    /// Cells at such a corner are so many times smaller.
    constexpr double corner_refinement = 3;


    bool is_mirror(const Outline::Sample &sample)
    {
      return sample.id == axis_id || sample.id == symmetry_id;
    }


    /// Edges of the surface that follow the curvature of tools it touches or comes near to: so many
    /// to a right angle.
    void demand_by_curvature(const Samples      &samples,
                             const scene::Scene &scene,
                             const double        time,
                             SizeField          &field)
    {
      const double growth = scene.remeshing.growth;
      const double angle  = 0.5 * M_PI / scene.remeshing.edges_per_right_angle;
      for (const scene::Tool &tool : scene.tools)
        {
          const Vector2 shift = tool.motion.displacement(time);
          for (const auto &loop : samples)
            for (const Outline::Sample &sample : loop)
              {
                std::array<tools::Contact, 2> found;
                if (is_mirror(sample) ||
                    tool.profile.find(Point(sample.x - shift), field.largest() / growth, found) ==
                        0 ||
                    found[0].curvature == 0)
                  continue;
                const double size = angle / std::abs(found[0].curvature);
                field.demand(sample.x, size + growth * std::max(0., found[0].gap));
              }
        }
    }


    /// Way from a place of the outline straight through the workpiece; infinity: it meets no
    /// surface that faces it.
    double thickness(const Samples &samples, const Outline::Sample &from)
    {
      double nearest = std::numeric_limits<double>::max(), result = nearest;
      for (const auto &loop : samples)
        for (std::size_t i = 0; i < loop.size(); ++i)
          {
            const Outline::Sample &a = loop[i], &b = loop[(i + 1) % loop.size()];
            // x + t n = a + u (b - a)
            const Vector2 d = b.x - a.x, e = a.x - from.x, n = from.inward;
            const double  det = n[1] * d[0] - n[0] * d[1];
            if (det == 0)
              continue;
            const double t = (d[0] * e[1] - d[1] * e[0]) / det;
            const double u = (n[0] * e[1] - n[1] * e[0]) / det;
            if (u < 0 || u > 1 || t <= 1e-3 * d.norm() || t >= nearest)
              continue;
            nearest = t;
            // A mirror line is half way through.
            result = is_mirror(a)                      ? 2 * t
                     : a.inward * from.inward < facing ? t
                                                       : std::numeric_limits<double>::max();
          }
      return result;
    }


    void demand_by_thickness(const Samples &samples, const double cells, SizeField &field)
    {
      for (const auto &loop : samples)
        for (const Outline::Sample &sample : loop)
          if (!is_mirror(sample))
            if (const double t = thickness(samples, sample); t < cells * field.largest())
              {
                field.demand(sample.x, t / cells);
                field.demand(sample.x + 0.5 * t * sample.inward, t / cells);
              }
    }


    /// The nearest symmetry line as a tool's surface would be: half of the gap lies behind it.
    bool nearest_symmetry(const Samples &samples, const Point &x, double &gap, Vector2 &normal)
    {
      gap = std::numeric_limits<double>::max();
      for (const auto &loop : samples)
        for (std::size_t i = 0; i < loop.size(); ++i)
          if (const Outline::Sample &a = loop[i]; a.id == symmetry_id)
            if (const double distance = std::abs((x - a.x) * a.inward); distance < gap)
              {
                gap    = distance;
                normal = a.inward;
              }
      return gap < std::numeric_limits<double>::max();
    }


    /// Where the surface comes to a gap between tools (of a flash, of the wall of a cup), or to the
    /// corner that two of them make, so many cells across.
    void demand_by_gaps(const Samples      &samples,
                        const scene::Scene &scene,
                        const double        time,
                        const double        cells,
                        SizeField          &field)
    {
      struct Side
      {
        double  gap;
        Vector2 normal;
      };
      std::vector<Side> sides;
      for (const auto &loop : samples)
        for (const Outline::Sample &sample : loop)
          {
            if (is_mirror(sample))
              continue;
            sides.clear();
            for (const scene::Tool &tool : scene.tools)
              {
                std::array<tools::Contact, 2> found;
                const unsigned int            n =
                    tool.profile.find(Point(sample.x - tool.motion.displacement(time)),
                                      cells * field.largest(), found);
                for (unsigned int i = 0; i < n; ++i)
                  sides.push_back({ std::max(0., found[i].gap), found[i].normal });
              }
            Side symmetry;
            if (nearest_symmetry(samples, sample.x, symmetry.gap, symmetry.normal))
              {
                for (Side &side : sides)
                  if (side.normal * symmetry.normal < facing)
                    field.demand(sample.x, 2 * (side.gap + symmetry.gap) / cells);
              }
            for (unsigned int i = 0; i < sides.size(); ++i)
              for (unsigned int j = 0; j < i; ++j)
                if (sides[i].normal * sides[j].normal < (sample.tool < 0 ? corner_facing : facing))
                  field.demand(sample.x, (sides[i].gap + sides[j].gap) / cells);
          }
    }


    /// Sharp convex corners of tools that the workpiece goes round, or is about to.
    void demand_by_corners(const Samples      &samples,
                           const scene::Scene &scene,
                           const double        time,
                           SizeField          &field)
    {
      for (const scene::Tool &tool : scene.tools)
        for (const tools::Profile::Corner &corner : tool.profile.corners())
          {
            if (corner.turn > -sharp_corner)
              continue;
            const Point x       = corner.place + tool.motion.displacement(time);
            double      nearest = std::numeric_limits<double>::max();
            for (const auto &loop : samples)
              for (const Outline::Sample &sample : loop)
                if (!is_mirror(sample))
                  nearest = std::min(nearest, sample.x.distance(x));
            if (nearest < field.largest())
              field.demand(x,
                           field.largest() / corner_refinement + scene.remeshing.growth * nearest);
          }
    }


    /// Cells with more than their share of the error get smaller: the error of a cell goes with
    /// its size to the power of 2 p + 2, p = 1 for Q2 elements where the solution is no smoother
    /// than it is at the edge of a tool.
    void demand_by_error(const Snapshot &old, const double ratio, SizeField &field)
    {
      double sum = 0;
      for (const CellSnapshot &cell : old.cells)
        sum += cell.error;
      const double mean = sum / old.cells.size();
      if (!(mean > 0))
        return;
      for (const CellSnapshot &cell : old.cells)
        {
          const auto  &x    = cell.position;
          const double area = 0.5 * std::abs((x[3][0] - x[0][0]) * (x[2][1] - x[1][1]) -
                                             (x[3][1] - x[0][1]) * (x[2][0] - x[1][0]));
          const double wanted =
              std::sqrt(area) * std::pow(mean / std::max(cell.error, 1e-12 * mean), 0.25);
          if (wanted < field.largest())
            field.demand(Point(x[8][0], x[8][1]), std::max(wanted, field.largest() / ratio));
        }
    }
  } // namespace


  SizeField make_size_field(const Outline      &outline,
                            const Snapshot     &old,
                            const scene::Scene &scene,
                            const double        time,
                            const double        size)
  {
    const scene::RemeshingParameters &wanted = scene.remeshing;
    SizeField field(size, wanted.smallest_size > 0 ? wanted.smallest_size : smallest_share * size,
                    wanted.growth);
    const Samples samples = outline.sample(0.2 * size);
    if (wanted.contact_refinement > 1)
      for (const Point &end : outline.contact_ends())
        field.demand(end, size / wanted.contact_refinement);
    if (wanted.edges_per_right_angle > 0)
      demand_by_curvature(samples, scene, time, field);
    demand_by_corners(samples, scene, time, field);
    if (wanted.cells_across > 0)
      {
        demand_by_gaps(samples, scene, time, wanted.cells_across, field);
        demand_by_thickness(samples, wanted.cells_across, field);
      }
    if (wanted.error_refinement > 1)
      demand_by_error(old, wanted.error_refinement, field);
    return field;
  }
} // namespace axiforge::meshing
