// SPDX-License-Identifier: GPL-2.0-or-later
#include <cmath>
#include <limits>

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>

#include <fmt/format.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/phases.h>
#include <axiforge/meshing/adapt.h>
#include <axiforge/meshing/mesh_checks.h>
#include <axiforge/meshing/outline_mesh.h>
#include <axiforge/meshing/remesh.h>
#include <axiforge/meshing/size_demands.h>
#include <axiforge/meshing/transfer.h>
#include <axiforge/meshing/volume.h>
#include <axiforge/state/pockets.h>

namespace axiforge::meshing
{
  namespace MPI = dealii::Utilities::MPI;

  namespace
  {
    /// After a try that failed, so many steps pass before the next one for the same reason.
    constexpr unsigned int patience = 5;

    /// How much worse than right after the last remeshing a mesh has to be for another.
    constexpr double worse_jacobian = 0.8, worse_penetration = 1.5;


    /// A new mesh is made where the middle node of a touching edge divides it into parts of which
    /// one is smaller than this [chord]; at 0.25 the edge turns back on itself.
    constexpr double smallest_division = 0.3;


    /// A step in which an edge comes to pass through a tool by more than this is not taken
    /// [length]: the surface has gone round a corner that the mesh does not see.
    constexpr double deepest_passage = 0.1;

    /// Edge length over sqrt(area / cells): gmsh's meshes have 1.3 times the cells of a square grid
    /// (324 wanted: 400 to 440 made).
    constexpr double size_for_cells = 1.14;

    /// Worst Jacobian at Gauss points and vertices of a mesh that needs no further try.
    constexpr double good_mesh = 0.2;


    /// Gaps between surface and tool that are closed, over the element size.
    constexpr double pocket_width = 0.5;

    /// Free surface that curls within four times this is cut, over the element size.
    constexpr double curl_width = 0.5;


    /// A new mesh may enclose another volume than the old one by this share, if none does it
    /// better.
    constexpr double largest_volume_change = 1e-4;


    struct Made
    {
      NewMesh mesh;
      double  volume_jump = 0;
      bool    restored    = false;
    };


    /// About how many cells a mesh with these sizes has: as many as the old cells would be cut
    /// into.
    double cells_of(const SizeField &field, const Snapshot &old)
    {
      double sum = 0;
      for (const CellSnapshot &cell : old.cells)
        {
          const auto  &x    = cell.position;
          const double area = 0.5 * std::abs((x[3][0] - x[0][0]) * (x[2][1] - x[1][1]) -
                                             (x[3][1] - x[0][1]) * (x[2][0] - x[1][0]));
          // At the middles of the four quarters: demands are steep near the surface.
          for (unsigned int v = 0; v < 4; ++v)
            {
              const double h =
                  field.at(Point(0.5 * (x[v][0] + x[8][0]), 0.5 * (x[v][1] + x[8][1])));
              sum += 0.25 * size_for_cells * size_for_cells * area / (h * h);
            }
        }
      return sum;
    }


    Made make_mesh(const Snapshot     &old,
                   const scene::Scene &scene,
                   const State        &state,
                   const double        volume,
                   const double        size_factor)
    {
      const Phase   phase("new mesh");
      Made          made;
      const Outline present(old, scene, state.time);
      const double  area = present.area();
      const double  size =
          size_factor * (scene.remeshing.element_size > 0
                             ? scene.remeshing.element_size
                             : size_for_cells * std::sqrt(area / state.remeshing.wanted_cells));
      made.mesh.fault = "gmsh makes no sound mesh";
      double best     = -1;
      // Where the outline is too rugged for a mesh, more of it is mended.
      for (const double mending : { 1., 2., 4. })
        {
          Outline outline = present;
          outline.close_pockets(mending * pocket_width * size);
          outline.cut_curls(mending * curl_width * size);
          SizeField field = [&] {
            const Phase phase("size field");
            return make_size_field(outline, old, scene, state.time, size);
          }();
          // Where the demands ask for too many cells, all of them are cut back alike.
          field.scale(std::max(1., std::sqrt(cells_of(field, old) / scene.remeshing.most_cells)));
          // Another division of the outline helps where the first gives no good mesh.
          for (const double factor : { 1., 0.93, 1.07, 0.86, 0.8, 1.15 })
            {
              SizeField scaled = field;
              scaled.scale(factor);
              const std::vector<NewLoop> loops = [&] {
                const Phase phase("outline");
                return outline.divide(scaled);
              }();
              NewMesh mesh = mesh_outline(loops, scaled, state.boundary_ids);
              if (!mesh.fault.empty())
                {
                  if (best < 0)
                    made.mesh.fault = mesh.fault;
                  continue;
                }
              const double jump = mesh.mesh.volume() - volume;
              bool         restored;
              {
                const Phase volume_phase("volume");
                restored = restore_volume(mesh, volume, size);
              }
              if (!restored && std::abs(jump) > largest_volume_change * volume)
                {
                  if (best < 0)
                    made.mesh.fault = fmt::format(
                        "the new outline would enclose {:+.2e} of the volume more", jump / volume);
                  continue;
                }
              if (const double value = smallest_scaled_jacobian(mesh.mesh); value > best)
                {
                  made.mesh        = std::move(mesh);
                  made.volume_jump = jump;
                  made.restored    = restored;
                  best             = value;
                }
              if (best > good_mesh)
                break;
            }
          if (best > 0)
            break;
        }
      return made;
    }


    /// That of the first rank for all of them.
    void share(Made &made, const MPI_Comm communicator)
    {
      made.mesh.fault = MPI::broadcast(communicator, made.mesh.fault, 0);
      if (!made.mesh.fault.empty())
        return;
      share_from_first_rank(made.mesh.mesh, communicator);
      made.volume_jump = MPI::broadcast(communicator, made.volume_jump, 0);
      made.restored    = MPI::broadcast(communicator, made.restored ? 1 : 0, 0) == 1;
    }


    std::vector<CarriedEdge> carried_edges(const NewMesh &mesh, const MPI_Comm communicator)
    {
      static_assert(sizeof(CarriedEdge) % sizeof(double) == 0);
      std::vector<double> numbers;
      for (const std::array<NewNode, 3> &nodes : mesh.boundary)
        {
          CarriedEdge edge;
          for (unsigned int a = 0; a < 3; ++a)
            {
              edge.position[a][0] = nodes[a].position[0];
              edge.position[a][1] = nodes[a].position[1];
              edge.node[a]        = nodes[a].carried;
            }
          const double *first = reinterpret_cast<const double *>(&edge);
          numbers.insert(numbers.end(), first, first + sizeof(CarriedEdge) / sizeof(double));
        }
      numbers = MPI::broadcast(communicator, numbers, 0);
      std::vector<CarriedEdge> edges(numbers.size() * sizeof(double) / sizeof(CarriedEdge));
      std::copy(numbers.begin(), numbers.end(), reinterpret_cast<double *>(edges.data()));
      return edges;
    }


    /// Faces, normals and gaps of the contacts at the present time.
    void complete_contacts(const scene::Scene &scene, State &state)
    {
      for (unsigned int b = 0; b < state.contacts.size(); ++b)
        {
          NodeContact &contact = state.contacts[b];
          for (unsigned int i = 0; i < 2 && contact.tool[i] != no_tool; ++i)
            {
              const scene::Tool            &tool = scene.tools[contact.tool[i]];
              std::array<tools::Contact, 2> found;
              const unsigned int            n =
                  tool.profile.find(Point(state.node_position(state.tables.boundary_nodes[b].node) -
                                          tool.motion.displacement(state.time)),
                                    std::numeric_limits<double>::max(), found);
              const unsigned int which = i == 1 && n == 2 && contact.tool[0] == contact.tool[1];
              if (n == 0)
                continue;
              contact.face[i]   = found[which].face;
              contact.normal[i] = found[which].normal;
              contact.gap[i]    = found[which].gap;
            }
        }
    }


    /// ZZ indicators of the owned cells in the order of the tables.
    std::vector<double> errors_of_cells(const scene::Scene &scene, const State &state)
    {
      double                      relative = 0;
      const dealii::Vector<float> indicators =
          error_indicators(state, scene.flow.regularisation * scene.characteristic_rate, relative);
      std::vector<double> errors;
      for (const dealii::CellId &id : state.tables.cell_ids)
        errors.push_back(
            indicators[state.triangulation.create_cell_iterator(id)->active_cell_index()]);
      return errors;
    }


    /// Smallest determinant at a Gauss point over its mean in the cell if everything goes on with
    /// the present velocity for a time [s].
    double predicted_jacobian(const State &state, const double time)
    {
      const dealii::QGauss<2> gauss(3);
      double                  worst = 1;
      for (const auto &numbers : state.tables.cells)
        {
          std::array<Point, 9> x;
          for (unsigned int a = 0; a < 9; ++a)
            for (unsigned int c = 0; c < 2; ++c)
              x[a][c] = state.position.local_element(2 * numbers[a] + c) +
                        time * state.velocity.local_element(2 * numbers[a] + c);
          double smallest = 1e300, area = 0;
          for (unsigned int q = 0; q < gauss.size(); ++q)
            {
              const double j = jacobian(x, gauss.point(q));
              smallest       = std::min(smallest, j);
              area += j * gauss.weight(q);
            }
          worst = std::min(worst, smallest / std::abs(area));
        }
      return MPI::min(worst, state.communicator);
    }


    double worst_jacobian(const Measures &measures)
    {
      return std::min(measures.smallest_jacobian, measures.smallest_vertex_jacobian);
    }
  } // namespace


  std::string reason_to_remesh(const scene::Scene &scene, const State &state)
  {
    const scene::RemeshingParameters &limits = scene.remeshing;
    const RemeshingRecord            &record = state.remeshing;
    if (!limits.enabled || state.step == 0 || state.step == record.last_attempt)
      return "";
    if (limits.every_steps > 0 && state.step % limits.every_steps == 0)
      return fmt::format("every {} steps", limits.every_steps);
    if (record.last_attempt > 0 && state.step < record.last_attempt + patience &&
        record.jacobian <= 0)
      return "";
    const Phase    phase("need of a new mesh");
    const Measures measures = measure(state);
    if (measures.smallest_jacobian <
        std::min(limits.smallest_jacobian, worse_jacobian * record.jacobian))
      return fmt::format("a Jacobian of {:.3g} near r = {:.4g} mm, z = {:.4g} mm",
                         measures.smallest_jacobian, measures.worst_place[0],
                         measures.worst_place[1]);
    if (measures.smallest_vertex_jacobian <
        std::min(limits.smallest_vertex_jacobian, worse_jacobian * record.vertex_jacobian))
      return fmt::format("a Jacobian of {:.3g} at a vertex", measures.smallest_vertex_jacobian);
    if (limits.smallest_predicted_jacobian > -1)
      if (const double predicted = predicted_jacobian(state, state.last_time_step);
          predicted <
          std::min(limits.smallest_predicted_jacobian, worse_jacobian * record.jacobian))
        return fmt::format("a Jacobian of {:.3g} in the next step", predicted);
    if (const double part = Outline::least_division(state);
        part < std::min(smallest_division, worse_jacobian * record.division))
      return fmt::format("a touching edge is divided at {:.3g} of its length", part);
    if (limits.cells_across > 0 &&
        (record.last_attempt == 0 || state.step >= record.last_attempt + patience) &&
        edge_over_gap(scene, state))
      return "an edge spans the mouth of a gap between tools";
    // A depth that comes back a few steps after a new mesh is what edges of this size leave.
    const double depth = Outline::penetration(state, scene, state.time);
    const double since = state.step - record.last_attempt;
    const double again = record.last_attempt > 0 ? 1 + patience / since : 1;
    if (depth >
        std::max(again * limits.largest_penetration, worse_penetration * record.penetration))
      return fmt::format("an edge passes through a tool by {:.3g} of its length", depth);
    return "";
  }


  Soundness soundness(const scene::Scene &scene, const State &state, const double time)
  {
    return { measure(state).smallest_vertex_jacobian, Outline::penetration(state, scene, time) };
  }


  std::string Soundness::lost_since(const Soundness &before) const
  {
    if (vertex_jacobian < std::min(0., before.vertex_jacobian))
      return fmt::format("a cell turns over at a vertex (Jacobian {:.3g})", vertex_jacobian);
    if (penetration > std::max(deepest_passage, worse_penetration * before.penetration))
      return fmt::format("an edge passes through a tool by {:.3g} of its length", penetration);
    return "";
  }


  RemeshResult remesh(const scene::Scene &scene, State &state, const double size_factor)
  {
    RemeshResult   result;
    const Measures before  = measure(state);
    result.cells_before    = state.tables.n_global_cells;
    result.jacobian_before = worst_jacobian(before);
    result.volume          = before.volume;
    if (state.remeshing.wanted_cells == 0)
      state.remeshing.wanted_cells = result.cells_before;
    state.remeshing.last_attempt = state.step;

    // What earlier meshes could not give back is given back by this one, if it can.
    const double   wanted_volume = before.volume + state.remeshing.missing_volume;
    const Snapshot old =
        take_snapshot(state, scene.remeshing.error_refinement > 1 ? errors_of_cells(scene, state)
                                                                  : std::vector<double>());
    Made made;
    if (MPI::this_mpi_process(state.communicator) == 0)
      try
        {
          made = make_mesh(old, scene, state, wanted_volume, size_factor);
        }
      catch (const std::exception &error)
        {
          made.mesh.fault = error.what();
        }
    share(made, state.communicator);
    if (!made.mesh.fault.empty())
      {
        result.fault             = made.mesh.fault;
        state.remeshing.jacobian = 0; // no trigger but a worse mesh for some steps
        return result;
      }

    result.strain_integral                  = strain_integral(state);
    const std::vector<CarriedEdge> boundary = carried_edges(made.mesh, state.communicator);
    state.clear_mesh();
    create_triangulation(made.mesh.mesh, state.triangulation);
    state.setup_dofs();
    interpolate_geometry(made.mesh.mesh, state.flow_dofs, state.position);
    state.setup_tables();
    {
      const Phase phase("transfer");
      transfer(old, boundary, state);
    }
    complete_contacts(scene, state);
    state.remeshing.missing_volume =
        made.restored ? 0 : give_volume_back(scene, state, wanted_volume);

    const Measures after    = measure(state);
    result.done             = true;
    result.cells            = state.tables.n_global_cells;
    result.jacobian         = worst_jacobian(after);
    result.volume_jump      = made.volume_jump;
    result.restored         = std::abs(state.remeshing.missing_volume) < 1e-9 * before.volume;
    result.strain_jump      = strain_integral(state) - result.strain_integral;
    RemeshingRecord &record = state.remeshing;
    ++record.count;
    record.volume_jump += result.volume_jump;
    record.strain_jump += result.strain_jump;
    record.jacobian        = after.smallest_jacobian;
    record.vertex_jacobian = after.smallest_vertex_jacobian;
    record.penetration     = Outline::penetration(state, scene, state.time);
    record.division        = Outline::least_division(state);
    return result;
  }


  std::string describe(const RemeshResult &result)
  {
    if (!result.done)
      return "the mesh stays: " + result.fault;
    return fmt::format(
        "{} -> {} cells, worst Jacobian {:.3g} -> {:.3g}, volume {:+.2e}{}, int "
        "strain dV {:+.2e}",
        result.cells_before, result.cells, result.jacobian_before, result.jacobian,
        result.volume_jump / result.volume, result.restored ? " (restored)" : " (not restored)",
        result.strain_integral > 0 ? result.strain_jump / result.strain_integral : 0.);
  }
} // namespace axiforge::meshing
