// SPDX-License-Identifier: GPL-2.0-or-later
#include <set>
#include <sstream>

#include <axiforge/base/errors.h>
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
    prm.add_parameter("Largest strain increment", largest_strain_increment,
                      "Largest effective strain a point may gain in one step. It guards against a "
                      "local burst; the reduction per step is the usual limit.",
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
    prm.add_parameter("Most steps", most_steps, "The run ends after so many steps.",
                      Patterns::Integer(1));
  }


  void FlowParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
        "Incompressibility", incompressibility,
        "'iterated penalty': the pressure is corrected in every iteration and the flow "
        "is incompressible at convergence whatever the penalty. 'penalty': the plain "
        "penalty method, p = lambda div v.",
        Patterns::Selection("iterated penalty|penalty"));
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
        "'cholmod': supernodal Cholesky, one rank only. 'mumps': through Trilinos, any "
        "number of ranks. 'automatic': cholmod on one rank, mumps on several.",
        Patterns::Selection("automatic|cholmod|mumps"));
    prm.add_parameter("Ordering", ordering,
                      "Fill-reducing ordering of cholmod. 'automatic': amd below 10,000 unknowns, "
                      "nested dissection above.",
                      Patterns::Selection("automatic|amd|nested dissection"));
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
        "levels counted.",
        Patterns::Integer(0, 20));
    prm.add_parameter("Most cells", most_cells, "No cell is divided when there are so many.",
                      Patterns::Integer(1));
    prm.add_parameter(
        "Smallest size", smallest_size,
        "Cells are not divided into smaller ones than this [mm] (their shorter diagonal). "
        "0: not used.",
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
    prm.add_parameter(
        "Refinement at contact ends", contact_refinement,
        "The element size over that where the surface leaves a tool; edges grow by 0.3 of the way "
        "from there. 4 halves the jumps of the force where surface folds on to tools, but meshes "
        "fail "
        "more often. 1: no refinement.",
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


  void ToolParameters::declare(ParameterHandler &prm)
  {
    geometry.declare_profile(prm);
    prm.enter_subsection("Motion");
    motion.declare(prm);
    prm.leave_subsection();
    prm.enter_subsection("Friction");
    friction.declare(prm);
    prm.leave_subsection();
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


  namespace
  {
    std::vector<std::string> split_names(const std::string &entry, const std::string &text)
    {
      std::vector<std::string> names;
      for (const std::string &name : dealii::Utilities::split_string_list(text))
        {
          if (name.empty() ||
              name.find_first_not_of(
                  "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") !=
                  std::string::npos)
            throw InputError::entry(entry, text, "\"" + name + "\" is not a name",
                                    "letters, digits, - and _, separated by commas",
                                    "The names stand in file names and column headers");
          if (std::count(names.begin(), names.end(), name))
            throw InputError::entry(entry, text, "\"" + name + "\" stands twice", "each name once");
          names.push_back(name);
        }
      return names;
    }
  } // namespace


  void SceneParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Title", title,
                      "One line that says what is simulated; it stands in the outputs.");
    prm.add_parameter(
        "Tools", tool_names,
        "Names of the tools, separated by commas; each has its own section 'Tool NAME'.");
    prm.add_parameter(
        "Boundaries", boundary_names,
        "Names of physical curves of the workpiece with a condition of their own; each "
        "has its section 'Boundary NAME'. Axis and symmetry need none.");
    prm.add_parameter("Gauges", gauge_names,
                      "Names of measurements of the shape, separated by commas; each has its "
                      "section 'Gauge NAME' and its column gauge_NAME_mm in history.csv.");
    prm.enter_subsection("Workpiece");
    workpiece.declare_workpiece(prm);
    prm.leave_subsection();
    prm.enter_subsection("Material");
    material.declare(prm);
    prm.leave_subsection();
    for (ToolParameters &tool : tools)
      {
        prm.enter_subsection("Tool " + tool.name);
        tool.declare(prm);
        prm.leave_subsection();
      }
    for (BoundaryParameters &boundary : boundaries)
      {
        prm.enter_subsection("Boundary " + boundary.name);
        boundary.declare(prm);
        prm.leave_subsection();
      }
    for (GaugeParameters &gauge : gauges)
      {
        prm.enter_subsection("Gauge " + gauge.name);
        gauge.declare(prm);
        prm.leave_subsection();
      }
    prm.enter_subsection("Process");
    process.declare(prm);
    prm.leave_subsection();
    prm.enter_subsection("Time stepping");
    time.declare(prm);
    prm.leave_subsection();
    prm.enter_subsection("Flow solver");
    flow.declare(prm);
    prm.leave_subsection();
    prm.enter_subsection("Refinement");
    refinement.declare(prm);
    prm.leave_subsection();
    prm.enter_subsection("Remeshing");
    remeshing.declare(prm);
    prm.leave_subsection();
    prm.enter_subsection("Folding");
    folding.declare(prm);
    prm.leave_subsection();
    prm.enter_subsection("Output");
    output.declare(prm);
    prm.leave_subsection();
    prm.enter_subsection("Study");
    study.declare(prm);
    prm.leave_subsection();
    prm.enter_subsection("Checkpoint");
    checkpoint.declare(prm);
    prm.leave_subsection();
  }


  SceneParameters::SceneParameters(const ParameterFile &file)
      : directory(file.directory())
      , handler(std::make_shared<ParameterHandler>())
  {
    // The lists of names come first: they say which sections there are.
    {
      ParameterHandler names;
      names.add_parameter("Tools", tool_names);
      names.add_parameter("Boundaries", boundary_names);
      names.add_parameter("Gauges", gauge_names);
      file.parse(names, true);
    }
    for (const std::string &name : split_names("Tools", tool_names))
      {
        tools.emplace_back();
        tools.back().name = name;
      }
    for (const std::string &name : split_names("Boundaries", boundary_names))
      {
        boundaries.emplace_back();
        boundaries.back().name = name;
      }
    for (const std::string &name : split_names("Gauges", gauge_names))
      {
        gauges.emplace_back();
        gauges.back().name = name;
      }
    // add_parameter keeps addresses: the vectors must not grow from here on.
    declare(*handler);
    file.parse(*handler);
  }


  std::string SceneParameters::print() const
  {
    std::ostringstream out;
    handler->print_parameters(out, ParameterHandler::PRM | ParameterHandler::KeepDeclarationOrder);
    return out.str();
  }
} // namespace axiforge::scene
