// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <gmsh.h>

#include <axiforge/base/cad_section.h>

namespace axiforge
{
  namespace
  {
    constexpr double pi = 3.14159265358979323846;

    struct Box
    {
      std::array<double, 3> lower, upper;

      double size() const
      {
        double largest = 0;
        for (unsigned int c = 0; c < 3; ++c)
          largest = std::max(largest, upper[c] - lower[c]);
        return largest;
      }
      bool is_flat(const unsigned int c) const
      {
        return upper[c] - lower[c] <= 1e-6 * size();
      }
    };

    Box box_of(const gmsh::vectorpair &entities)
    {
      Box box{ { { 1e300, 1e300, 1e300 } }, { { -1e300, -1e300, -1e300 } } };
      for (const auto &[dim, tag] : entities)
        {
          std::array<double, 3> lower, upper;
          gmsh::model::occ::getBoundingBox(dim, tag, lower[0], lower[1], lower[2], upper[0],
                                           upper[1], upper[2]);
          for (unsigned int c = 0; c < 3; ++c)
            {
              box.lower[c] = std::min(box.lower[c], lower[c]);
              box.upper[c] = std::max(box.upper[c], upper[c]);
            }
        }
      return box;
    }

    /// An axis of revolution of the file and the turn that brings gmsh's plane, x = r and y = z,
    /// to it.
    struct Axis
    {
      const char           *name;
      std::array<double, 3> about;
      double                angle;

      void turn(const gmsh::vectorpair &entities, const bool back) const
      {
        if (angle != 0)
          gmsh::model::occ::rotate(entities, 0, 0, 0, about[0], about[1], about[2],
                                   back ? -angle : angle);
      }
    };

    const std::array<Axis, 3> axes = { { { "y", { { 1, 0, 0 } }, 0 },
                                         { "z", { { 1, 0, 0 } }, pi / 2 },
                                         { "x", { { 1, 1, 0 } }, pi } } };

    /// The section of the solids with the half plane beside an axis, in gmsh's plane; empty if they
    /// are no bodies of revolution about it.
    gmsh::vectorpair cut(const gmsh::vectorpair &solids, const Axis &axis)
    {
      const double reach = 2 * box_of(solids).size();
      double       far   = 0;
      for (unsigned int c = 0; c < 3; ++c)
        far =
            std::max({ far, std::abs(box_of(solids).lower[c]), std::abs(box_of(solids).upper[c]) });
      const double           extent = far + reach;
      const gmsh::vectorpair half   = { { 2, gmsh::model::occ::addRectangle(0, -extent, 0, extent,
                                                                            2 * extent) } };
      axis.turn(half, false);
      gmsh::vectorpair              section;
      std::vector<gmsh::vectorpair> origins;
      gmsh::model::occ::intersect(solids, half, section, origins, -1, /* removeObject = */ false,
                                  /* removeTool = */ true);
      axis.turn(section, true);

      double solid = 0, of_revolution = 0; // Pappus: area times the way of its centre
      for (const auto &[dim, tag] : solids)
        {
          double volume;
          gmsh::model::occ::getMass(dim, tag, volume);
          solid += volume;
        }
      for (const auto &[dim, tag] : section)
        {
          double area, x, y, z;
          gmsh::model::occ::getMass(dim, tag, area);
          gmsh::model::occ::getCenterOfMass(dim, tag, x, y, z);
          of_revolution += 2 * pi * x * area;
        }
      if (std::abs(of_revolution - solid) > 1e-4 * solid)
        {
          gmsh::model::occ::remove(section, /* recursive = */ true);
          section.clear();
        }
      return section;
    }

    int section_of_solids(const gmsh::vectorpair &solids, const FaultOfFile &wrong)
    {
      for (const Axis &axis : axes)
        {
          const gmsh::vectorpair section = cut(solids, axis);
          if (section.size() > 1)
            throw wrong(fmt::format("its solids have a section of {} parts", section.size()),
                        "The workpiece is one piece: give a file with it alone");
          if (section.size() == 1)
            {
              // What is left of the solids would be meshed, too.
              gmsh::model::occ::remove(solids, /* recursive = */ true);
              gmsh::model::occ::synchronize();
              return section.front().second;
            }
        }
      throw wrong("its solid is none of revolution about the x, y or z axis of the file",
                  "Put its axis there, or export the meridian section as a plane face");
    }

    /// Turns plane entities into gmsh's plane.
    void turn_to_plane(const gmsh::vectorpair &entities, const FaultOfFile &wrong)
    {
      const Box box = box_of(entities);
      if (box.is_flat(2))
        gmsh::model::occ::translate(entities, 0, 0, -(box.lower[2] + box.upper[2]) / 2);
      else if (box.is_flat(1))
        {
          axes[1].turn(entities, true);
          gmsh::model::occ::translate(entities, 0, 0, (box.lower[1] + box.upper[1]) / 2);
        }
      else if (box.is_flat(0))
        {
          gmsh::model::occ::translate(entities, -(box.lower[0] + box.upper[0]) / 2, 0, 0);
          gmsh::model::occ::rotate(entities, 0, 0, 0, 0, 0, 1, -pi / 2);
          axes[1].turn(entities, true);
        }
      else
        throw wrong("it does not lie in a plane of the file's axes",
                    "Draw the meridian section in the x, y plane (x = r, y = z) or the x, z plane");
      if (box_of(entities).upper[0] <= 1e-6 * box.size()) // drawn on the left of the axis
        gmsh::model::occ::rotate(entities, 0, 0, 0, 0, 1, 0, pi);
      gmsh::model::occ::synchronize();
    }

    int
    chosen_face(const std::string &face, const gmsh::vectorpair &faces, const FaultOfFile &wrong)
    {
      std::vector<std::string> known;
      int                      largest      = 0;
      double                   largest_area = -1;
      for (const auto &[dim, tag] : faces)
        {
          double area;
          gmsh::model::occ::getMass(dim, tag, area);
          known.push_back(fmt::format("{} ({:.4g} mm^2)", tag, area));
          if (area > largest_area)
            {
              largest      = tag;
              largest_area = area;
            }
          if (face == std::to_string(tag))
            return tag;
        }
      if (face == "largest" && !faces.empty())
        return largest;
      throw wrong(
          fmt::format("its faces are {}, and \"Workpiece/Face\" = \"{}\"", fmt::join(known, ", "),
                      face),
          "Set \"Workpiece/Face\" to the number of the meridian section, or to \"largest\"");
    }
  } // namespace

  int section_of_cad(const std::string &face, const FaultOfFile &wrong)
  {
    gmsh::vectorpair solids, faces;
    gmsh::model::getEntities(solids, 3);
    gmsh::model::getEntities(faces, 2);
    if (faces.empty())
      throw wrong("it has no face", "The workpiece has to be a plane face, x = r and y = z, or a "
                                    "solid of revolution");
    if (face.empty() && !solids.empty())
      return section_of_solids(solids, wrong);
    int tag =
        face.empty() && faces.size() == 1 ? faces.front().second : chosen_face(face, faces, wrong);
    if (faces.size() > 1) // it may share its edges with others
      {
        gmsh::vectorpair copied;
        gmsh::model::occ::copy({ { 2, tag } }, copied);
        tag = copied.at(0).second;
      }
    turn_to_plane({ { 2, tag } }, wrong);
    return tag;
  }

  std::vector<int> curves_of_cad(const FaultOfFile &wrong)
  {
    gmsh::vectorpair solids, faces, curves;
    gmsh::model::getEntities(solids, 3);
    gmsh::model::getEntities(faces, 2);
    gmsh::model::getEntities(curves, 1);
    if (!solids.empty())
      {
        const int section = section_of_solids(solids, wrong);
        gmsh::model::getBoundary({ { 2, section } }, curves, false, false);
      }
    else if (!curves.empty() && !box_of(curves).is_flat(2))
      {
        turn_to_plane(faces.empty() ? curves : faces, wrong);
        gmsh::model::getEntities(curves, 1);
      }
    std::vector<int> tags;
    for (const auto &[dim, tag] : curves)
      tags.push_back(std::abs(tag));
    return tags;
  }
} // namespace axiforge
