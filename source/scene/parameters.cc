// SPDX-License-Identifier: GPL-2.0-or-later
#include <set>
#include <sstream>

#include <axiforge/base/errors.h>
#include <axiforge/base/notes.h>
#include <axiforge/scene/scene.h>

namespace axiforge::scene
{
  using dealii::ParameterHandler;
  namespace Patterns = dealii::Patterns;

  void ProcessParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
        "Driving tool", driving_tool,
        "The tool whose travel is called the stroke. Empty: the first tool that moves.");
    prm.add_parameter(
        "End stroke", end_stroke,
        "The run ends when the driving tool has travelled this far [mm]. 0: not used.",
        Patterns::Double(0));
    prm.add_parameter(
        "End time", end_time,
        "The run ends at this time [s]. 0: not used. With both, the earlier one counts.",
        Patterns::Double(0));
    prm.add_parameter(
        "End force", end_force,
        "The run ends when the force of the driving tool reaches this [N], to 0.1 %: steps are cut "
        "short to meet it. Stroke or time stay the most that it may take. 0: not used.",
        Patterns::Double(0));
    prm.add_parameter(
        "End height", end_height,
        "The run ends when the workpiece (of a half model: its half) is no higher than "
        "this [mm]. Stroke or time stay the most that it may take. 0: not used.",
        Patterns::Double(0));
    prm.add_parameter(
        "End fill", end_fill,
        "The run ends when this share of the cavity inside \"Fill radius\" is filled, "
        "for instance 0.995. Stroke or time stay the most that it may take. 0: not used.",
        Patterns::Double(0, 1));
    prm.add_parameter(
        "Fill radius", fill_radius,
        "Radius R [mm] up to which the cavity between the tools counts, as a rule the inner edge "
        "of "
        "the flash land. history.csv gets a column fill: the volume of the workpiece at r < R over "
        "that between the tools, as far as they stand now. 0: not computed.",
        Patterns::Double(0));
    prm.add_parameter(
        "Dwell", dwell,
        "Time [s] that passes after this operation, at rest or on the way to the next. "
        "Without heat nothing else happens in it.",
        Patterns::Double(0));
  }


  void TimeParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
        "Scheme", scheme_name,
        "'midpoint': implicit midpoint rule on the updated Lagrangian mesh, second order "
        "in time. 'explicit euler': the classical update with the geometry at the start "
        "of the step, first order; it loses volume and is there for comparison.",
        Patterns::Selection("midpoint|explicit euler"));
    prm.add_parameter(
        "Stroke per step", stroke_per_step,
        "Travel of the driving tool in one step [mm]. 0: chosen from the limits below.",
        Patterns::Double(0));
    prm.add_parameter("Time step", time_step,
                      "Length of a step [s]. 0: chosen from the limits below or from the stroke.",
                      Patterns::Double(0));
    prm.add_parameter(
        "Largest reduction per step", largest_reduction,
        "Travel of the fastest tool in one step over the present height of the "
        "workpiece, used when no step is given. 0.01 keeps the time error of the force "
        "near 1e-4.",
        Patterns::Double(1e-6, 0.5));
    prm.add_parameter(
        "Largest strain increment", largest_strain_increment,
        "Largest effective strain that the workpiece may gain in one step, but for the "
        "points with 1 % of the plastic power. It guards against a local burst; the "
        "reduction per step is the usual limit.",
        Patterns::Double(1e-6));
    prm.add_parameter(
        "Largest motion", largest_motion,
        "Largest relative motion of the nodes of a cell in one step, as a share of the "
        "size of the cell.",
        Patterns::Double(1e-3, 1));
    prm.add_parameter("Smallest step", smallest_step,
                      "A step that fails is repeated with half its length until it is shorter than "
                      "this share of the step that was wanted; then the run ends (status 2).",
                      Patterns::Double(1e-12, 1));
    prm.add_parameter("Most steps", most_steps,
                      "A run that needs more stops after so many, with a checkpoint and status 2.",
                      Patterns::Integer(1));
  }


  void FlowParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
        "Incompressibility", incompressibility,
        "'iterated penalty': the pressure is corrected in every iteration and the flow "
        "is incompressible at convergence whatever the penalty. 'penalty': the plain "
        "penalty method, p = lambda div v, the pressure of a cell being an unknown that "
        "is condensed. 'classical penalty': the same with lambda div v in the residual "
        "itself; for comparison, it loses as many digits as lambda has.",
        Patterns::Selection("iterated penalty|penalty|classical penalty"));
    prm.add_parameter(
        "Penalty", penalty,
        "lambda over the viscosity sigma / (3 epsdot) at the reference rate. With the "
        "iterated penalty at least 10 over the regularisation; with the plain penalty "
        "the usual 10^5 to 10^7 is a compromise.",
        Patterns::Double(1));
    prm.add_parameter("Iteration", iteration,
                      "'newton': primal-dual Newton. 'picard': the viscosity of the last iterate "
                      "(direct iteration), slow and sure.",
                      Patterns::Selection("newton|picard"));
    prm.add_parameter(
        "Regularisation", regularisation,
        "eps0 over the reference rate: epsdot_reg^2 = epsdot^2 + eps0^2. 1e-3 costs less "
        "than 1e-5 of the force.",
        Patterns::Double(1e-12, 1));
    prm.add_parameter(
        "Reference strain rate", reference_rate,
        "The rate that scales regularisation and penalty [1/s]. 0: largest speed of a "
        "tool over the height of the workpiece.",
        Patterns::Double(0));
    prm.add_parameter(
        "Tolerance", tolerance,
        "For the residual of the forces over the sum of the cells' forces, and for the "
        "divergence over the strain rate.",
        Patterns::Double(1e-14, 1));
    prm.add_parameter(
        "Most iterations", most_iterations,
        "A step that takes more has failed and is repeated shorter. Picard iterations "
        "may need some hundreds.",
        Patterns::Integer(1));
    prm.add_parameter(
        "Linear solver", linear_solver,
        "'cholmod': supernodal Cholesky on the first rank, for all. 'mumps': through Trilinos, on "
        "all ranks. 'automatic': cholmod; mumps on several ranks beyond 3 million unknowns.",
        Patterns::Selection("automatic|cholmod|mumps"));
    prm.add_parameter("Ordering", ordering,
                      "Fill-reducing ordering of cholmod. 'automatic': amd below 10,000 unknowns, "
                      "nested dissection above.",
                      Patterns::Selection("automatic|amd|nested dissection"));
    prm.add_parameter(
        "Estimate condition", estimate_condition,
        "Whether history.csv gets a column condition: an estimate of the condition number of "
        "the last matrix of each step, rows and columns scaled to a unit diagonal. It costs 40 "
        "more solves in a step. Only with cholmod; nan with mumps.");
  }


  void RefinementParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
        "Enabled", enabled,
        "Whether cells are divided and joined during the run where the error indicator "
        "(recovery of the deviatoric stress) says so.");
    prm.add_parameter("Every steps", every_steps, "The mesh is adapted after so many steps.",
                      Patterns::Integer(1));
    prm.add_parameter(
        "Start cycles", start_cycles,
        "The first step is solved so many times on meshes adapted in between before it "
        "counts.",
        Patterns::Integer(0));
    prm.add_parameter("Refine fraction", refine_fraction,
                      "The cells with the largest indicators that hold this share of their sum are "
                      "divided.",
                      Patterns::Double(0, 1));
    prm.add_parameter(
        "Coarsen fraction", coarsen_fraction,
        "Families of cells with the smallest indicators that hold this share of the sum "
        "are joined, where the outline stays as it is.",
        Patterns::Double(0, 1));
    prm.add_parameter(
        "Largest level", largest_level,
        "How many times a cell of the file's mesh may be divided, the initial refinement "
        "levels counted. With a target accuracy errors may divide them 10 times.",
        Patterns::Integer(0, 20));
    prm.add_parameter("Most cells", most_cells, "No cell is divided when there are so many.",
                      Patterns::Integer(1));
    prm.add_parameter(
        "Smallest size", smallest_size,
        "Cells are not divided into smaller ones than this [mm] (their shorter diagonal). "
        "0: not used.",
        Patterns::Double(0));
    prm.add_parameter(
        "Largest chord error", largest_chord_error,
        "A cell is divided if its edge between touching nodes is off the tool's profile by more "
        "than this share of the edge's length: a fillet, or surface that folds over. 0: not used.",
        Patterns::Double(0));
    prm.add_parameter(
        "Edges per quarter circle", edges_per_quarter,
        "So many edges of the surface there should be along a quarter of a circle with the radius "
        "of curvature of the tool that it touches. 3 keeps a curved edge within 1e-4 of the "
        "radius. 0: not used.",
        Patterns::Double(0));
  }


  void RemeshingParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
        "Enabled", enabled,
        "Whether the workpiece gets a new mesh (gmsh) when its cells are distorted, and "
        "when a step fails.");
    prm.add_parameter(
        "Smallest Jacobian", smallest_jacobian,
        "A new mesh is made when the determinant at a Gauss point over its mean in the cell (1: "
        "undistorted, 0: turns over) falls below this, and below 0.8 of what the last new mesh "
        "had.",
        Patterns::Double(0, 1));
    prm.add_parameter(
        "Smallest vertex Jacobian", smallest_vertex_jacobian,
        "The same at the corners of the cells, where the surface folds on to a tool. -1: not used.",
        Patterns::Double(-1, 1));
    prm.add_parameter("Smallest predicted Jacobian", smallest_predicted_jacobian,
                      "The same at the Gauss points, as it would be after another step like the "
                      "last one: a cell that "
                      "is about to turn over gets a new mesh before the step fails. -1: not used.",
                      Patterns::Double(-1, 1));
    prm.add_parameter(
        "Largest penetration", largest_penetration,
        "A new mesh is made when an edge passes through a tool between its nodes by more than this "
        "share of its length, and by more than 1.5 times what the last new mesh had.",
        Patterns::Double(0));
    prm.add_parameter(
        "Every steps", every_steps,
        "A new mesh after so many steps, whatever the old one looks like. 0: not used.",
        Patterns::Integer(0));
    prm.add_parameter(
        "Element size", element_size,
        "Length of the edges of the new cells [mm]. 0: about as many cells as at the start.",
        Patterns::Double(0));
    prm.add_parameter("Smallest size", smallest_size,
                      "No edge is asked to be shorter than this [mm], whatever the entries below "
                      "say. 0: a tenth of "
                      "the element size.",
                      Patterns::Double(0));
    prm.add_parameter("Growth", growth,
                      "By how much edges may be longer a way of 1 farther on (dh/dx). 0.3: an edge "
                      "is about a third "
                      "longer than its neighbour, which quadrilaterals follow without bad angles.",
                      Patterns::Double(0.05, 1));
    prm.add_parameter("Edges per right angle", edges_per_right_angle,
                      "Where the surface touches, or comes near to, a curved part of a tool, so "
                      "many edges follow a "
                      "right angle of it. 3: the parabola of an edge is off an arc by a thousandth "
                      "of its radius at "
                      "most. 0: not used.",
                      Patterns::Double(0, 50));
    prm.add_parameter(
        "Cells across", cells_across,
        "At least about so many cells between two surfaces that face each other: walls, flash. 3: "
        "enough for a parabolic flow with friction on both sides. 0: not used.",
        Patterns::Double(0, 50));
    prm.add_parameter("Error refinement", error_refinement,
                      "Cells are smaller where the error indicator (ZZ) of the old mesh is above "
                      "its mean, down to "
                      "the element size over this. 1: not used.",
                      Patterns::Double(1, 20));
    prm.add_parameter("Refinement at contact ends", contact_refinement,
                      "The element size over that where the surface leaves a tool. 4 halves the "
                      "jumps of the force "
                      "where surface folds on to tools. 1: no refinement.",
                      Patterns::Double(1, 20));
    prm.add_parameter(
        "Most cells", most_cells,
        "The element size is raised so that a new mesh has about so many cells at most.",
        Patterns::Integer(4));
  }


  void OutputParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Directory", directory,
                      "Folder of the results, relative to where the program is started. Empty: "
                      "results/ and the name of the .prm.");
    prm.add_parameter(
        "Fields every stroke", interval_stroke,
        "Fields (VTU) are written whenever the stroke has grown by this much [mm], and "
        "at the start and end. 0: not used.",
        Patterns::Double(0));
    prm.add_parameter("Fields every steps", interval_steps,
                      "Fields are written after so many steps, and at the start and end. 0 with no "
                      "stroke given: 20 times in the run.",
                      Patterns::Integer(0));
    prm.add_parameter("Fields", format, "'vtu': fields for ParaView. 'none': only history.csv.",
                      Patterns::Selection("vtu|none"));
  }


  void CheckpointParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
        "Every steps", every_steps,
        "All that a run needs to go on is written to checkpoint.axi, in the folder of "
        "the results, after every so many steps, for --resume. 0: not by steps. Without "
        "any entry here it is written when a run cannot go on and on a signal.",
        Patterns::Integer(0));
    prm.add_parameter("Every minutes", every_minutes,
                      "The same whenever so much time has passed on the wall [min]. 0: not used.",
                      Patterns::Double(0));
  }


  void PlacementParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Flip", flip,
                      "Turn the workpiece over first: z changes its sign about the middle of its "
                      "height. Its strains go with it.");
    prm.add_parameter("Move", move,
                      "Move it along z by this much [mm] then; with \"Rest on\" after it rests.");
    prm.add_parameter("Rest on", rest_on,
                      "Name of a tool: the workpiece is put above it, then lowered until it "
                      "touches it. Empty: it "
                      "stays where it is.");
  }


  void BoundaryParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
        "Type", type,
        "'velocity': the components given below are prescribed. 'pressure': a pressure "
        "acts on the boundary as it moves.",
        Patterns::Selection("velocity|pressure"));
    prm.add_parameter(
        "Velocity r", velocity_r,
        "An expression in r, z [mm] and t [s] for the radial velocity [mm/s], or 'free'.");
    prm.add_parameter("Velocity z", velocity_z,
                      "An expression in r, z and t for the axial velocity [mm/s], or 'free'.");
    prm.add_parameter("Pressure", pressure,
                      "An expression in r, z and t for the pressure [MPa] on the workpiece.");
  }
} // namespace axiforge::scene
