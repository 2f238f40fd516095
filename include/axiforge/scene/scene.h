// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <deal.II/base/parameter_handler.h>

#include <axiforge/base/geometry.h>
#include <axiforge/base/geometry_parameters.h>
#include <axiforge/base/parameter_file.h>
#include <axiforge/laws/friction.h>
#include <axiforge/laws/material.h>
#include <axiforge/scene/accuracy_parameters.h>
#include <axiforge/scene/folding_parameters.h>
#include <axiforge/scene/gauge.h>
#include <axiforge/scene/study_parameters.h>
#include <axiforge/tools/motion.h>
#include <axiforge/tools/profile.h>
#include <axiforge/tools/profile_reader.h>

namespace axiforge::scene
{
  /// `subsection Process`: what the run, or the operation, ends with.
  struct ProcessParameters
  {
    std::string driving_tool;
    double      end_stroke  = 0;
    double      end_time    = 0;
    double      end_force   = 0; ///< [N]
    double      end_height  = 0; ///< [mm]
    double      end_fill    = 0; ///< share, see fill_fraction()
    double      fill_radius = 0; ///< [mm]; 0: the fill is not computed
    double      dwell       = 0; ///< [s]

    void declare(dealii::ParameterHandler &prm);
  };

  enum class TimeScheme
  {
    midpoint,
    explicit_euler
  };

  /// `subsection Time stepping`
  struct TimeParameters
  {
    std::string  scheme_name              = "midpoint";
    double       stroke_per_step          = 0;
    double       time_step                = 0;
    double       largest_reduction        = 0.01;
    double       largest_strain_increment = 0.1;
    double       largest_motion           = 0.25;
    double       smallest_step            = 1e-4;
    unsigned int most_steps               = 100000;

    TimeScheme scheme() const
    {
      return scheme_name == "midpoint" ? TimeScheme::midpoint : TimeScheme::explicit_euler;
    }

    void declare(dealii::ParameterHandler &prm);
  };

  /// `subsection Flow solver`
  struct FlowParameters
  {
    std::string  incompressibility  = "iterated penalty";
    double       penalty            = 1e8;
    std::string  iteration          = "newton";
    double       regularisation     = 1e-3;
    double       reference_rate     = 0;
    double       tolerance          = 1e-5;
    unsigned int most_iterations    = 60;
    std::string  linear_solver      = "automatic";
    std::string  ordering           = "automatic";
    bool         estimate_condition = false;

    bool iterated() const
    {
      return incompressibility == "iterated penalty";
    }
    /// Whether the residual takes lambda div v itself for the pressure.
    bool classical() const
    {
      return incompressibility == "classical penalty";
    }
    bool newton() const
    {
      return iteration == "newton";
    }

    void declare(dealii::ParameterHandler &prm);
  };

  /// `subsection Refinement`
  struct RefinementParameters
  {
    bool         enabled             = false;
    unsigned int every_steps         = 5;
    unsigned int start_cycles        = 0;
    double       refine_fraction     = 0.3;
    double       coarsen_fraction    = 0.02;
    unsigned int largest_level       = 3;
    unsigned int largest_by_error    = 0; ///< level to which errors may divide cells, if larger
    unsigned int most_cells          = 20000;
    double       smallest_size       = 0;
    double       largest_chord_error = 0.01; ///< over the length of the edge
    double       edges_per_quarter   = 3;    ///< of a circle of the tool

    void declare(dealii::ParameterHandler &prm);
  };

  /// `subsection Remeshing`: a new mesh for the workpiece where the old one is used up.
  struct RemeshingParameters
  {
    bool         enabled                     = false;
    double       smallest_jacobian           = 0.25;
    double       smallest_vertex_jacobian    = 0.05;
    double       smallest_predicted_jacobian = 0.1;
    double       largest_penetration         = 0.02;
    unsigned int every_steps                 = 0;
    double       element_size                = 0; ///< [mm]; 0: as many cells as at the start
    double       smallest_size               = 0; ///< [mm]; 0: a tenth of the element size
    double       growth                      = 0.3;
    double       edges_per_right_angle       = 3;
    double       cells_across                = 3;
    double       error_refinement            = 1;
    double       contact_refinement          = 1;
    unsigned int most_cells                  = 20000;

    void declare(dealii::ParameterHandler &prm);
  };

  /// `subsection Output`

  struct OutputParameters
  {
    std::string  directory;
    double       interval_stroke = 0;
    unsigned int interval_steps  = 0;
    std::string  format          = "vtu";

    void declare(dealii::ParameterHandler &prm);
  };

  /// `subsection Checkpoint`
  struct CheckpointParameters
  {
    unsigned int every_steps   = 0; ///< 0: not by steps
    double       every_minutes = 0; ///< 0: not by the clock

    bool regular() const
    {
      return every_steps > 0 || every_minutes > 0;
    }

    void declare(dealii::ParameterHandler &prm);
  };

  /// `subsection Placement`: what is done to the workpiece before the first step.
  struct PlacementParameters
  {
    bool        flip = false;
    double      move = 0; ///< along z [mm]
    std::string rest_on;  ///< name of a tool

    bool any() const
    {
      return flip || move != 0 || !rest_on.empty();
    }

    void declare(dealii::ParameterHandler &prm);
  };

  /// `subsection Tool NAME`
  struct ToolParameters
  {
    std::string              name;
    std::string              start = "as drawn";
    GeometryParameters       geometry;
    tools::MotionParameters  motion;
    laws::FrictionParameters friction;

    void declare(dealii::ParameterHandler &prm);
  };

  /// `subsection Boundary NAME`: a condition on a named part of the workpiece's boundary.
  struct BoundaryParameters
  {
    std::string name;
    std::string type       = "velocity";
    std::string velocity_r = "free", velocity_z = "free", pressure;

    void declare(dealii::ParameterHandler &prm);
  };

  /**
   * Everything a .prm says of one operation (the only one, in most scenes), as read: values within
   * their patterns, but not yet checked against each other or against the mesh.
   */
  struct SceneParameters
  {
    explicit SceneParameters(const ParameterFile &file);

    std::string                     title;
    std::string                     operation; ///< name of this operation; empty: there are none
    PlacementParameters             placement;
    GeometryParameters              workpiece;
    laws::MaterialParameters        material;
    std::vector<ToolParameters>     tools;
    std::vector<BoundaryParameters> boundaries;
    std::vector<GaugeParameters>    gauges;
    ProcessParameters               process;
    TimeParameters                  time;
    FlowParameters                  flow;
    RefinementParameters            refinement;
    RemeshingParameters             remeshing;
    FoldingParameters               folding;
    OutputParameters                output;
    StudyParameters                 study; ///< for `axiforge study` alone
    CheckpointParameters            checkpoint;
    AccuracyParameters              accuracy;
    std::vector<RegionParameters>   regions;
    std::string                     directory; ///< of the .prm: relative names are resolved there

    /// All entries with their values in effect and their texts, in .prm form.
    std::string print() const;

    /// Reads the files that tools and material name. @throws InputError
    void check_files() const;

    /// Of each section that is not enabled, the entries that it is given for nothing, in words; by
    /// its name.
    std::map<std::string, std::string> idle_entries(const ParameterFile &file) const;

  private:
    void declare(dealii::ParameterHandler &prm);

    /// Of `section`, the entries given that are not at their defaults in @p defaults, in words.
    template <typename Parameters>
    std::string changed_entries(const ParameterFile &file,
                                const std::string   &section,
                                Parameters           defaults) const;

    std::string tool_names, boundary_names, operation_names, region_names, gauge_names;
    std::shared_ptr<dealii::ParameterHandler> handler;
  };

  /**
   * The parameters of a scene's operations, in their order: of each `subsection Operation NAME`
   * named in the entry `Operations` what stands in it over what stands outside of these sections.
   * One element, without a name, if the scene has no operations. Files that the sections name
   * (profiles, tables) are read, so that a mistake in the last operation does not wait until then.
   * @throws InputError
   */
  std::vector<SceneParameters> read_operations(const ParameterFile &file);

  /// All entries there are with their defaults and texts, in .prm form: one section of each family
  /// (tools, boundaries, regions, gauges), with the name NAME.
  std::string print_all_entries();

  /// Does something and puts the name of the operation before the message of an InputError or
  /// ComputationError that comes out; with an empty name nothing is added.
  void in_operation(const std::string &name, const std::function<void()> &action);

  /// What the scene needs to know of the meshed workpiece to check and complete itself.
  struct WorkpieceOutline
  {
    std::vector<Point>       boundary_points; ///< of the surface that can touch tools
    std::vector<std::string> boundary_names;
    Point                    lower, upper; ///< bounding box [mm]
    /// Points of each part of the boundary that has a name of its own.
    std::map<std::string, std::vector<Point>> named_points;
  };

  struct Tool
  {
    std::string    name;
    tools::Profile profile;
    tools::Motion  motion;
    laws::Friction friction;
  };

  /// Velocity or pressure on a named part of the workpiece's boundary.
  struct BoundaryCondition
  {
    std::string name;
    bool        is_velocity;
    /// (position, time) -> [mm/s]; an empty one leaves the component free.
    std::function<double(const Point &, double)> velocity[2];
    std::function<double(const Point &, double)> pressure; ///< [MPa]
  };

  /**
   * The scene: everything the .prm says, checked, and const from then on.
   */
  class Scene
  {
  public:
    /**
     * Checks the parameters against each other and against the workpiece.
     * @throws InputError that names entry, value, what is allowed and the way out
     */
    Scene(const SceneParameters &parameters, const WorkpieceOutline &outline);

    std::string                    title;
    laws::Material                 material;
    std::vector<Tool>              tools;
    std::vector<BoundaryCondition> boundaries;
    std::vector<Gauge>             gauges;
    ProcessParameters              process;
    TimeParameters                 time;
    FlowParameters                 flow;
    RefinementParameters           refinement;
    RemeshingParameters            remeshing;
    FoldingParameters              folding;
    OutputParameters               output;
    CheckpointParameters           checkpoint;
    Accuracy                       accuracy;
    std::vector<Region>            regions;

    unsigned int
           driving_tool; ///< index of the tool whose travel is the stroke; no_tool without tools
    double characteristic_speed; ///< V [mm/s], largest speed of a tool or boundary at the start
    double characteristic_rate;  ///< V/H [1/s]
    double size;                 ///< largest extent of the workpiece [mm]

    /// Force per volume (r, z) [N/mm^3] at a point of the current configuration; empty: none.
    std::function<Vector2(const Point &)> body_force;

    /// Travel of the driving tool [mm] at a time [s].
    double stroke(double time) const;

    /// Time [s] at which the run ends, if force, height or fill do not end it before.
    double end_time() const
    {
      return end_time_;
    }

  private:
    double end_time_;
  };
} // namespace axiforge::scene
