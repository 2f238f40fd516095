// SPDX-License-Identifier: GPL-2.0-or-later
#include <fstream>
#include <sstream>

#include <axiforge/base/atomic_file.h>
#include <axiforge/base/collective.h>
#include <axiforge/state/checkpoint.h>
#include <axiforge/state/portable_archive.h>

namespace axiforge
{
  namespace
  {
    /// To be raised with every change of what a file holds.
    constexpr std::uint32_t format_version = 6;
    const std::string       magic          = "AXIFORGE CHECKPOINT\n";
    constexpr std::uint32_t byte_order     = 0x01020304;
  } // namespace


  template <typename Archive> void visit(Archive &archive, ToolRecord &object)
  {
    auto &[force, radial_force, contact_radius, neutral_radius, end_force, force_slope] = object;
    archive(force, radial_force, contact_radius, neutral_radius, end_force, force_slope);
  }

  template <typename Archive> void visit(Archive &archive, BoundaryRecord &object)
  {
    auto &[force, power, pressure] = object;
    archive(force, power, pressure);
  }

  template <typename Archive> void visit(Archive &archive, StepTimes &object)
  {
    auto &[residual, assembly, factor, solve, contact, total] = object;
    archive(residual, assembly, factor, solve, contact, total);
  }

  template <typename Archive> void visit(Archive &archive, ErrorEstimate &object)
  {
    auto &[space, time, regularisation, nonlinear] = object;
    archive(space, time, regularisation, nonlinear);
  }

  template <typename Archive> void visit(Archive &archive, AccuracyRecord &object)
  {
    auto &[space_factor, checked, last_check, largest, sum, largest_total, time, steps, above] =
        object;
    archive(space_factor, checked, last_check, largest, sum, largest_total, time, steps, above);
  }

  template <typename Archive> void visit(Archive &archive, StepRecord &object)
  {
    auto &[step, time, time_step, stroke, time_middle, stroke_middle, tools, boundaries, gauges,
           volume, relative_volume_change, power_tools, power_boundaries, power_plastic,
           power_friction, power_contact, power_volume, power_residual, largest_strain,
           largest_strain_rate, smallest_jacobian, smallest_vertex_jacobian, largest_radius, height,
           fill, time_to_fill, end_force, tension, cells, unknowns, iterations, set_changes,
           repeats, residual, divergence, condition, times, remeshings, remeshing_volume_jump,
           remeshing_strain_jump, errors] = object;
    // All but the condition, which nothing that follows depends on.
    archive(step, time, time_step, stroke, time_middle, stroke_middle, tools, boundaries, gauges,
            volume, relative_volume_change, power_tools, power_boundaries, power_plastic,
            power_friction, power_contact, power_volume, power_residual, largest_strain,
            largest_strain_rate, smallest_jacobian, smallest_vertex_jacobian, largest_radius,
            height, fill, time_to_fill, end_force, tension, cells, unknowns, iterations,
            set_changes, repeats, residual, divergence, times, remeshings, remeshing_volume_jump,
            remeshing_strain_jump, errors);
  }

  template <typename Archive> void visit(Archive &archive, ResultsProgress &object)
  {
    auto &[n_rows, last_step, field_files, tool_files, last_fields_step, last_fields_stroke,
           last_fields_time, wall_seconds] = object;
    archive(n_rows, last_step, field_files, tool_files, last_fields_step, last_fields_stroke,
            last_fields_time, wall_seconds);
  }

  template <typename Archive> void visit(Archive &archive, OperationSummary &object)
  {
    auto &[name, ended_by, steps, time, stroke, height, fill, force, largest_force, work, imbalance,
           volume_change, largest_strain, largest_radius, cells, remeshings, wall_seconds] = object;
    archive(name, ended_by, steps, time, stroke, height, fill, force, largest_force, work,
            imbalance, volume_change, largest_strain, largest_radius, cells, remeshings,
            wall_seconds);
  }

  template <typename Archive> void visit(Archive &archive, scene::WorkpieceOutline &object)
  {
    auto &[boundary_points, boundary_names, lower, upper, named_points] = object;
    archive(boundary_points, boundary_names, lower, upper, named_points);
  }

  template <typename Archive> void visit(Archive &archive, ChainProgress &object)
  {
    auto &[outline, finished, present] = object;
    archive(outline, finished, present);
  }

  template <typename Archive> void visit(Archive &archive, CheckpointExtras &object)
  {
    auto &[parameters, record, results, chain] = object;
    archive(parameters, record, results, chain);
  }

  /// The numbers of the state that belong to no cell and no node.
  template <typename Archive> void visit(Archive &archive, RemeshingRecord &object)
  {
    auto &[count, volume_jump, strain_jump, missing_volume, wanted_cells, last_attempt, jacobian,
           vertex_jacobian, penetration, division] = object;
    archive(count, volume_jump, strain_jump, missing_volume, wanted_cells, last_attempt, jacobian,
            vertex_jacobian, penetration, division);
  }

  template <typename Archive> void visit_numbers(Archive &archive, State &state)
  {
    archive(state.boundary_ids, state.time, state.step, state.last_time_step,
            state.earlier_time_step, state.initial_volume, state.size, state.remeshing,
            state.accuracy);
  }

  namespace
  {
    /// The content of a file behind its head, which is checked.
    std::string read_content(const std::string &path)
    {
      std::ifstream in(path, std::ios::binary);
      if (!in)
        throw InputError("There is no checkpoint \"" + path +
                         "\", or it cannot be read. Name the folder of the results or the file "
                         "behind --resume, or start without it.");
      std::ostringstream buffer;
      buffer << in.rdbuf();
      const std::string text = buffer.str();
      if (text.compare(0, magic.size(), magic) != 0)
        throw InputError("\"" + path +
                         "\" is no checkpoint of axiforge. Name the folder of the results or its "
                         "checkpoint.axi behind --resume.");
      const std::string head = text.substr(0, magic.size() + 2 * 4 + 2 * 8);
      const std::string body = head.substr(magic.size());
      BinaryReader      reader(body, path);
      std::uint32_t     order = 0, version = 0;
      std::uint64_t     size = 0, sum = 0;
      reader(order, version, size, sum);
      if (order != byte_order || version != format_version)
        throw InputError(
            order != byte_order
                ? "\"" + path + "\" was written on a machine with another order of bytes."
                : fmt::format("\"{}\" was written by another version of the program: its format "
                              "is {}, this one reads {}. Continue with the version in versions.txt "
                              "beside it.",
                              path, version, format_version));
      const std::string content = text.substr(head.size());
      const std::string way_out =
          " The one before it is kept as checkpoint.old.axi: try --resume with that file.";
      if (content.size() != size)
        throw InputError(fmt::format("\"{}\" is damaged: it has {} bytes of content, {} were "
                                     "written.{}",
                                     path, content.size(), size, way_out));
      if (checksum(content) != sum)
        throw InputError("\"" + path + "\" is damaged: its checksum does not fit." + way_out);
      return content;
    }
  } // namespace


  namespace
  {
    /// All of a state and what goes with it, on the first rank.
    std::string content_of(const State &state, const CheckpointExtras &extras)
    {
      BinaryWriter   mine;
      portable::Part part = portable::locally_owned_part(state);
      mine(part);
      const std::vector<std::string> parts = gather_on_first_rank(state.communicator, mine.text);
      BinaryWriter                   content;
      if (parts.empty())
        return {};
      // The writer reads only.
      content(const_cast<CheckpointExtras &>(extras));
      visit_numbers(content, const_cast<State &>(state));
      portable::CoarseMesh mesh = portable::coarse_mesh(state);
      content(mesh);
      content.size_of(parts.size());
      for (const std::string &text : parts)
        content.text += text;
      return content.text;
    }


    /// The same, read by all ranks.
    CheckpointExtras fill_from(State &state, const std::string &content, const std::string &name)
    {
      BinaryReader         reader(content, name);
      CheckpointExtras     extras;
      portable::CoarseMesh mesh;
      reader(extras);
      visit_numbers(reader, state);
      std::vector<portable::Part> parts;
      reader(mesh, parts);
      portable::rebuild(mesh, parts, state, name);
      return extras;
    }
  } // namespace


  void copy_state(const State &from, State &to)
  {
    std::string content = content_of(from, CheckpointExtras());
    share_text_of_first_rank(from.communicator, content);
    fill_from(to, content, "copy of the state");
  }


  void save_checkpoint(const State &state, const CheckpointExtras &extras, const std::string &path)
  {
    const std::string content = content_of(state, extras);
    on_first_rank(state.communicator, [&] {
      BinaryWriter  head;
      std::uint32_t order = byte_order, version = format_version;
      std::uint64_t size = content.size(), sum = checksum(content);
      head(order, version, size, sum);
      AtomicFile file(path);
      file.stream() << magic << head.text << content;
      file.commit();
    });
  }


  CheckpointExtras load_checkpoint(State &state, const std::string &path)
  {
    std::string content;
    on_first_rank(state.communicator, [&] { content = read_content(path); });
    share_text_of_first_rank(state.communicator, content);

    return fill_from(state, content, path);
  }
} // namespace axiforge
