// SPDX-License-Identifier: GPL-2.0-or-later
#include <sstream>
#include <string_view>

#include <deal.II/base/parameter_handler.h>

#include <axiforge/base/csv.h>
#include <axiforge/base/geometry_parameters.h>

namespace axiforge
{
  void GeometryParameters::declare_workpiece(dealii::ParameterHandler &prm)
  {
    physical_group = "workpiece";

    prm.add_parameter(
        "Geometry file", file,
        "File with the workpiece's meridian section, lengths in mm, x = r and y = z: a gmsh .geo "
        "(meshed "
        "with quadrilaterals when the run starts), a .msh of quadrilaterals (4, 8 or 9 nodes), or "
        "a "
        ".step, .stp or .brep with a plane face. Relative to the folder of this parameter file. No "
        "default: a simulation has one.");
    prm.add_parameter(
        "Geometry parameters", parameters,
        "Values for the parameters of a .geo, as in \"Radius = 25, Height = 25\"; those left out "
        "keep "
        "the default of the file. A .geo declares one by DefineConstant[ Radius = {25, Name "
        "\"Radius\"} ];");
    prm.add_parameter(
        "Physical group", physical_group,
        "Name of gmsh's physical surface that is the workpiece. A file with a single surface and "
        "no "
        "physical surfaces needs none. Physical curves on its boundary: \"axis\" (found by itself "
        "where r = 0), \"symmetry\" (straight, the material slides along it); other names can be "
        "given "
        "boundary conditions.");
    prm.add_parameter(
        "Face", face,
        "Which face of a .step, .stp or .brep is the workpiece's meridian section: its number as "
        "gmsh counts them, or \"largest\". Empty (default): the only one; a solid of revolution is "
        "cut along its meridian.");
    prm.add_parameter(
        "Element size", element_size,
        "Edge length of the elements [mm] that gmsh aims at; where the section is narrow they come "
        "out "
        "down to half as long. 0 (default): as the file says, so that a structured "
        "(transfinite) .geo and a .msh are taken as they are. No effect on these two.",
        dealii::Patterns::Double(0.));
    prm.add_parameter("Refinement levels", refinement_levels,
                      "How many times every element of the file's mesh is divided into four before "
                      "the simulation "
                      "starts, curved edges included. 0 (default): the mesh as it is.",
                      dealii::Patterns::Integer(0, 8));
  }

  void GeometryParameters::declare_profile(dealii::ParameterHandler &prm)
  {
    physical_group = "tool";
    prm.add_parameter(
        "Geometry file", file,
        "File with the tool's profile in the meridian plane at the start of the simulation, "
        "lengths in "
        "mm, x = r and y = z: a gmsh .geo, .msh, .step, .stp or .brep (lines and circular arcs "
        "stay "
        "exact, splines to 1e-6 of their size), or a .csv polyline with the columns r_mm, z_mm. "
        "Relative to the folder of this parameter file. No default: a tool has one.");
    prm.add_parameter("Geometry parameters", parameters,
                      "Values for the parameters of a .geo, as in \"Radius = 25, Z = 25\"; those "
                      "left out keep the "
                      "default of the file.");
    prm.add_parameter("Physical group", physical_group,
                      "Name of gmsh's physical curve that is the tool's surface. Empty: all curves "
                      "of the file. A CAD "
                      "file (.step, .stp, .brep) has no groups, there it is always all curves. "
                      "Curves on the axis "
                      "r = 0 are left out. Not used for .csv.");
  }

  std::string with_geometry_parameter(const std::string &list,
                                      const std::string &name,
                                      const std::string &value)
  {
    std::istringstream parts(list);
    std::string        part, result;
    bool               found = false;
    while (std::getline(parts, part, ','))
      {
        part = trim(part);
        if (part.empty())
          continue;
        const bool here = trim(std::string_view(part).substr(0, part.find('='))) == name;
        found           = found || here;
        result += (result.empty() ? "" : ", ") + (here ? name + " = " + value : part);
      }
    if (!found)
      result += (result.empty() ? "" : ", ") + name + " = " + value;
    return result;
  }
} // namespace axiforge
