// SPDX-License-Identifier: GPL-2.0-or-later
#include <sstream>

#include <deal.II/base/mpi.h>
#include <deal.II/fe/mapping_fe_field.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>
#include <axiforge/output/results.h>
#include <axiforge/state/recovery.h>

namespace axiforge::output
{
  using namespace dealii;

  std::shared_ptr<DataOut<2>> collect_fields(const State &state)
  {
    const auto &history = state.cell_history;

    Field contact(state.velocity);
    contact = 0;
    for (unsigned int b = 0; b < state.contacts.size(); ++b)
      if (const BoundaryNode &node = state.tables.boundary_nodes[b];
          node.owned && state.contacts[b].active())
        {
          contact.local_element(2 * node.node)     = state.contacts[b].pressure;
          contact.local_element(2 * node.node + 1) = state.contacts[b].traction;
        }
    contact.update_ghost_values();

    const Field strain   = recover(state, [&](const unsigned int cell, const unsigned int q) {
      return std::array<double, 2>{ { state.strain.local_element(
                                            state.tables.first_strain_dof[cell] + q),
                                      history[cell].strain_rate[q] } };
    });
    const Field stress   = recover(state, [&](const unsigned int cell, const unsigned int q) {
      const auto  &S = history[cell].stress[q];
      const double effective =
          std::sqrt(1.5 * (S[0] * S[0] + S[1] * S[1] + S[2] * S[2] + 2 * S[3] * S[3]));
      return std::array<double, 2>{ { effective, history[cell].mean_stress[q] } };
    });
    const Field normal   = recover(state, [&](const unsigned int cell, const unsigned int q) {
      return std::array<double, 2>{ { history[cell].stress[q][0] + history[cell].mean_stress[q],
                                      history[cell].stress[q][1] + history[cell].mean_stress[q] } };
    });
    const Field other    = recover(state, [&](const unsigned int cell, const unsigned int q) {
      return std::array<double, 2>{ { history[cell].stress[q][2] + history[cell].mean_stress[q],
                                      history[cell].stress[q][3] } };
    });
    const Field pressure = recover(state, [&](const unsigned int cell, const unsigned int q) {
      return std::array<double, 2>{ { -history[cell].mean_stress[q],
                                      history[cell].flow_stress[q] } };
    });

    using Interpretation = DataComponentInterpretation::DataComponentInterpretation;
    const std::vector<Interpretation> vector(
        2, DataComponentInterpretation::component_is_part_of_vector);
    const std::vector<Interpretation> scalars(2, DataComponentInterpretation::component_is_scalar);

    const auto            out = std::make_shared<DataOut<2>>();
    DataOutBase::VtkFlags flags;
    flags.write_higher_order_cells = true;
    flags.time                     = state.time;
    flags.cycle                    = state.step;
    flags.print_date_and_time      = false; // the same run gives the same bytes
    // zlib would take a third off the file and more time than all the rest of it.
    flags.compression_level = DataOutBase::VtkFlags::no_compression;
    out->set_flags(flags);
    const auto add = [&](const Field &field, const std::string &first, const std::string &second) {
      out->add_data_vector(state.flow_dofs, field, std::vector<std::string>{ first, second },
                           scalars);
    };
    state.velocity.update_ghost_values();
    out->add_data_vector(state.flow_dofs, state.velocity, std::vector<std::string>(2, "velocity"),
                         vector);
    add(strain, "strain", "strain_rate");
    add(stress, "effective_stress", "mean_stress");
    add(normal, "stress_rr", "stress_zz");
    add(other, "stress_tt", "stress_rz");
    add(pressure, "pressure", "flow_stress");
    add(contact, "contact_pressure", "friction_traction");

    const MappingFEField<2, 2, Field> mapping(state.flow_dofs, state.position);
    out->build_patches(mapping, 2, DataOut<2>::curved_inner_cells);
    out->clear_input_data_references();
    return out;
  }


  void write_vtu(const DataOut<2> &fields, const std::string &path)
  {
    std::ostringstream text;
    fields.write_vtu(text);
    write_file_atomically(path, text.str());
  }


  void write_vtu_in_parallel(const DataOut<2>  &fields,
                             const std::string &path,
                             const MPI_Comm     communicator)
  {
    // Under another name first: a run that is killed leaves no half-written file.
    const std::string temporary = path + ".part";
    fields.write_vtu_in_parallel(temporary, communicator);
    on_first_rank(communicator, [&] {
      if (std::rename(temporary.c_str(), path.c_str()) != 0)
        throw ComputationError("The file " + path + " can't be written. Is the disk full?");
    });
  }


  void write_tools(const scene::Scene &scene, const double time, const std::string &path)
  {
    std::string  points, connectivity, offsets, indices;
    unsigned int n_points = 0, n_lines = 0;
    for (unsigned int tool = 0; tool < scene.tools.size(); ++tool)
      {
        const Vector2 shift = scene.tools[tool].motion.displacement(time);
        for (const auto &line : scene.tools[tool].profile.sample(1e-4 * scene.size))
          {
            for (const Point &x : line)
              {
                points += fmt::format("{:.9g} {:.9g} 0\n", x[0] + shift[0], x[1] + shift[1]);
                connectivity += fmt::format("{} ", n_points++);
              }
            offsets += fmt::format("{} ", n_points);
            indices += fmt::format("{} ", tool);
            ++n_lines;
          }
      }
    std::string types;
    for (unsigned int i = 0; i < n_lines; ++i)
      types += "4 "; // VTK_POLY_LINE
    write_file_atomically(
        path,
        fmt::format(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" "
            "version=\"0.1\">\n<UnstructuredGrid>\n"
            "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n"
            "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
            "format=\"ascii\">\n{}</DataArray></Points>\n"
            "<Cells>\n<DataArray type=\"Int32\" Name=\"connectivity\" "
            "format=\"ascii\">{}</DataArray>\n"
            "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">{}</DataArray>\n"
            "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">{}</DataArray>\n</Cells>\n"
            "<CellData Scalars=\"tool\"><DataArray type=\"Int32\" Name=\"tool\" "
            "format=\"ascii\">{}</DataArray>"
            "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
            n_points, n_lines, points, connectivity, offsets, types, indices));
  }
} // namespace axiforge::output
