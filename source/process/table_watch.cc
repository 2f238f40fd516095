// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <iostream>
#include <limits>

#include <deal.II/base/mpi.h>

#include <fmt/format.h>

#include <axiforge/process/table_watch.h>

namespace axiforge::process
{
  namespace
  {
    /// Share of the work outside of the table from which on it is told.
    constexpr double worth_telling = 0.01;

    /// Points with at least this share of the largest power density show which range is used.
    constexpr double hard_work = 0.05;

    /// Volume that belongs to each of a cell's points, over 2 pi: the area of the quadrilateral
    /// times the radius of its centre, shared equally. Near enough for a share of the work.
    double volume_of_point(const State &state, const std::array<unsigned int, 9> &nodes)
    {
      std::array<Point, 4> x;
      for (unsigned int v = 0; v < 4; ++v)
        x[v] = state.node_position(nodes[v]);
      const Vector2 a = x[3] - x[0], b = x[2] - x[1];
      const double  radius = (x[0][0] + x[1][0] + x[2][0] + x[3][0]) / 4;
      return std::abs(a[0] * b[1] - a[1] * b[0]) / 2 * radius / 9;
    }
  } // namespace


  TableWatch::TableWatch(const scene::Scene &scene, const bool quiet)
      : table(scene.material.table())
      , quiet(quiet)
      , lowest_rate(std::numeric_limits<double>::max())
  {
  }


  void TableWatch::after_step(const State &state, const double time_step)
  {
    if (table == nullptr)
      return;
    const bool   rates      = table->highest_rate() > table->lowest_rate();
    const double round_off  = 1e-9;
    const double low        = table->lowest_rate() * (1 - round_off);
    const double high       = table->highest_rate() * (1 + round_off);
    const double far        = table->last_strain() * (1 + round_off);
    double       most_power = 0;
    for (const CellHistory &cell : state.cell_history)
      for (unsigned int q = 0; q < 9; ++q)
        most_power = std::max(most_power, cell.flow_stress[q] * cell.strain_rate[q]);
    for (unsigned int c = 0; c < state.cell_history.size(); ++c)
      {
        const CellHistory &cell   = state.cell_history[c];
        const double       volume = volume_of_point(state, state.tables.cells[c]);
        for (unsigned int q = 0; q < 9; ++q)
          {
            const double rate   = cell.strain_rate[q];
            const double power  = cell.flow_stress[q] * rate;
            const double strain = state.strain.local_element(state.tables.first_strain_dof[c] + q);
            work += power * volume * time_step;
            if (strain > far || (rates && (rate < low || rate > high)))
              work_outside += power * volume * time_step;
            if (power < hard_work * most_power)
              continue;
            largest_strain = std::max(largest_strain, strain);
            highest_rate   = std::max(highest_rate, rate);
            lowest_rate    = std::min(lowest_rate, rate);
          }
      }
  }


  void TableWatch::tell(const State &state) const
  {
    using namespace dealii::Utilities::MPI;
    if (table == nullptr)
      return;
    const double all     = sum(work, state.communicator);
    const double outside = sum(work_outside, state.communicator);
    const double slowest = min(lowest_rate, state.communicator);
    const double fastest = max(highest_rate, state.communicator);
    const double largest = max(largest_strain, state.communicator);
    if (this_mpi_process(state.communicator) != 0 || !(outside > worth_telling * all))
      return;
    std::string measured = fmt::format("strains up to {:.4g}", table->last_strain());
    std::string used     = fmt::format("strains up to {:.4g}", largest);
    if (table->highest_rate() > table->lowest_rate())
      {
        measured += fmt::format(" and rates from {:.4g} to {:.4g} 1/s", table->lowest_rate(),
                                table->highest_rate());
        used += fmt::format(" and rates from {:.4g} to {:.4g} 1/s", slowest, fastest);
      }
    // Told in any case; apart from what --quiet asks for.
    (quiet ? std::cerr : std::cout)
        << fmt::format("Warning: {:.0f} % of the plastic work was done outside of the table of "
                       "\"Material/Table file\": it has {}, the workpiece has {}. The stress there "
                       "is that of the table's edge; extend the table.\n",
                       100 * outside / all, measured, used)
        << std::flush;
  }
} // namespace axiforge::process
