// SPDX-License-Identifier: GPL-2.0-or-later
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include <deal.II/base/mpi.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/input_files.h>
#include <axiforge/base/phases.h>
#include <axiforge/process/checkpointing.h>

namespace axiforge::process
{
  namespace
  {
    /// Set by the handlers, which may do nothing else; read after each step.
    volatile std::sig_atomic_t write_wanted = 0, stop_wanted = 0;

    extern "C" void on_request(int)
    {
      write_wanted = 1;
    }

    extern "C" void on_stop(const int signal)
    {
      stop_wanted = signal;
    }


    struct CaughtSignal
    {
      int              number;
      const char      *name;
      struct sigaction before;
    };
    CaughtSignal caught[] = { { SIGUSR1, "", {} },
                              { SIGTERM, "SIGTERM", {} },
                              { SIGINT, "SIGINT", {} },
                              { SIGHUP, "SIGHUP: its terminal was closed", {} },
                              { SIGPIPE, "SIGPIPE: nobody reads its output any more", {} } };

    void set_handlers()
    {
      write_wanted = stop_wanted = 0;
      for (CaughtSignal &signal : caught)
        {
          struct sigaction action = {};
          action.sa_handler       = signal.number == SIGUSR1 ? on_request : on_stop;
          action.sa_flags         = SA_RESTART;
          // The second one ends the program at once; but a broken pipe is met with every line.
          if (signal.number != SIGUSR1 && signal.number != SIGPIPE)
            action.sa_flags |= SA_RESETHAND;
          sigaction(signal.number, &action, &signal.before);
          // As nohup does with SIGHUP, and a script's background jobs with Ctrl-C.
          if (signal.before.sa_handler == SIG_IGN)
            sigaction(signal.number, &signal.before, nullptr);
        }
    }


    void reset_handlers()
    {
      for (const CaughtSignal &signal : caught)
        sigaction(signal.number, &signal.before, nullptr);
    }


    /// "(SIGTERM)", of the signal that asked to stop.
    std::string name_of(const int number)
    {
      for (const CaughtSignal &signal : caught)
        if (signal.number == number)
          return std::string(" (") + signal.name + ")";
      return "";
    }


    const std::string of_operation = "Operation ";


    /// The name of the operation an entry belongs to; empty without operations.
    std::string operation_of(const std::string &path)
    {
      return path.compare(0, of_operation.size(), of_operation) == 0
                 ? path.substr(of_operation.size(), path.find('/') - of_operation.size())
                 : "";
    }


    /// Entries that say nothing about the body and what is done to it.
    bool may_differ(std::string path)
    {
      if (!operation_of(path).empty())
        path.erase(0, path.find('/') + 1);
      for (const char *section : { "Output/", "Checkpoint/", "Time stepping/", "Flow solver/",
                                   "Study/", "Folding/", "Remeshing/" })
        if (path.compare(0, std::string(section).size(), section) == 0)
          return path != "Remeshing/Enabled"; // history.csv would have other columns
      return path == "Title" || path.compare(0, 12, "Process/End ") == 0 ||
             path == "Process/Dwell" || path == "Operations";
    }
  } // namespace


  Checkpointing::Checkpointing(const std::string &folder, const std::string &parameters)
      : folder(folder)
      , parameters(parameters)
  {
    set_handlers();
  }


  Checkpointing::~Checkpointing()
  {
    reset_handlers();
  }


  void Checkpointing::enter(const scene::Scene  &new_scene,
                            const ChainProgress &new_chain,
                            output::Results     &new_results)
  {
    scene     = &new_scene;
    chain     = &new_chain;
    results   = &new_results;
    last_step = static_cast<unsigned int>(-1);
  }


  void Checkpointing::write(const State &state, const StepRecord &record)
  {
    const Phase            phase("checkpoint");
    const std::string      path     = folder + "/checkpoint.axi";
    const ResultsProgress &progress = results->progress(); // throws before anything is touched
    on_first_rank(state.communicator, [&] {
      // At any moment there is a whole file called checkpoint.axi: the old one gets a second name
      // before the new one takes its place.
      const std::string old = folder + "/checkpoint.old.axi", link = folder + "/.checkpoint.link";
      std::error_code   error;
      std::filesystem::remove(link, error);
      if (!std::filesystem::exists(path, error))
        return;
      std::filesystem::create_hard_link(path, link, error);
      if (error) // a file system without links
        std::filesystem::copy_file(path, link, error);
      if (!error)
        std::filesystem::rename(link, old, error);
    });
    save_checkpoint(state, { parameters, record, progress, *chain }, path);
    last_step = state.step;
    last_kept = fmt::format(
        "after step {}{}", state.step,
        chain->present.name.empty() ? "" : " of operation \"" + chain->present.name + "\"");
    since_last.restart();
  }


  bool Checkpointing::after_step(const State &state, const StepRecord &record)
  {
    // The signal may have reached one rank only, and the clocks differ.
    enum Wish
    {
      none,
      regular,
      request,
      stop
    };
    const scene::CheckpointParameters &when = scene->checkpoint;
    int                                wish = none;
    if ((when.every_steps > 0 && state.step % when.every_steps == 0) ||
        (when.every_minutes > 0 && since_last.wall_time() >= 60 * when.every_minutes))
      wish = regular;
    if (write_wanted)
      wish = request;
    if (stop_wanted)
      wish = stop + stop_wanted;
    wish         = dealii::Utilities::MPI::max(wish, state.communicator);
    write_wanted = 0;
    if (wish > stop)
      throw ComputationError(fmt::format(
          "The run was asked to stop by a signal{} and has done so at time {:.6g} s, stroke {:.6g} "
          "mm, after step {}.",
          name_of(wish - stop), state.time, scene->stroke(state.time), state.step));
    if (wish != none)
      write(state, record);
    return wish == request;
  }


  void Checkpointing::at_end(const State &state, const StepRecord &record)
  {
    if ((scene->checkpoint.regular() || more_follow) && last_step != state.step)
      write(state, record);
  }


  std::string Checkpointing::rescue(const State &state, const StepRecord &record) noexcept
  {
    try
      {
        results->finish();
      }
    catch (const std::exception &)
      {
        // Files of fields that could not be written are no reason to lose the state.
      }
    try
      {
        // If the step's row could not be written, its state would leave a gap: the checkpoint
        // before it stays.
        if (state.step > 0 && last_step != state.step &&
            results->progress().last_step == state.step)
          write(state, record);
        if (last_kept.empty())
          return {};
        return fmt::format(" The state {} is kept in \"{}\": --resume continues there.", last_kept,
                           folder + "/checkpoint.axi");
      }
    catch (const std::exception &error)
      {
        std::error_code   ignored;
        const std::string path = folder + "/checkpoint.axi";
        return fmt::format(" There is no checkpoint of this state: {}{}", error.what(),
                           std::filesystem::exists(path, ignored)
                               ? " The one before it stays in \"" + path +
                                     "\": --resume continues there."
                               : "");
      }
  }


  bool stopped_by_signal(const MPI_Comm communicator)
  {
    return dealii::Utilities::MPI::max(static_cast<int>(stop_wanted), communicator) != 0;
  }


  std::string find_checkpoint(const std::string &from, const std::string &folder)
  {
    namespace fs = std::filesystem;
    std::error_code ignored;
    const fs::path  given  = from.empty() ? folder : from;
    const bool      is_dir = from.empty() || fs::is_directory(given, ignored);
    const fs::path  home   = is_dir                    ? given
                             : given.has_parent_path() ? given.parent_path()
                                                       : fs::path(".");
    if (fs::exists(given, ignored) && fs::weakly_canonical(home) != fs::weakly_canonical(folder))
      throw InputError(fmt::format("--resume \"{}\" continues in the folder of that checkpoint, "
                                   "but --output says \"{}\". Leave --output out, or copy the "
                                   "folder and name the copy in both.",
                                   from, folder));
    return is_dir ? (given / "checkpoint.axi").string() : given.string();
  }


  void check_same_scene(const std::string              &before,
                        const std::string              &now,
                        const std::vector<std::string> &begun,
                        const std::string              &path)
  {
    const auto matters = [&](const std::string &entry) {
      const std::string operation = operation_of(entry);
      return !may_differ(entry) &&
             (operation.empty() || std::find(begun.begin(), begun.end(), operation) != begun.end());
    };
    // Files are compared by what is in them, wherever they lie.
    std::set<std::string> same;
    const auto            files = fingerprints_in(before);
    for (const Fingerprint &is : fingerprints_in(now))
      for (const Fingerprint &was : files)
        if (was.entry == is.entry && matters(is.entry))
          {
            if (was.checksum != is.checksum)
              throw InputError::entry(
                  is.entry, is.path,
                  fmt::format("what is in the file, or in one that it includes, has changed since "
                              "the checkpoint \"{}\" was written with \"{}\"",
                              path, was.path),
                  "the file of then, which is kept in the folder input of the results",
                  "Put it back, or start without --resume");
            same.insert(is.entry);
          }
    const auto list = [](const std::string &text) {
      const auto                         entries = entries_of_text(text);
      std::map<std::string, std::string> found;
      for (const auto &[entry, value] : entries)
        found[entry] = value;
      return found;
    };
    const auto old_entries = list(before), new_entries = list(now);
    const auto differs = [&](const std::string &entry, const std::string &was,
                             const std::string &is) {
      return InputError::entry(
          entry, is, fmt::format("the checkpoint \"{}\" was written with \"{}\"", path, was),
          "the value of the checkpoint; only title, end of the run, time stepping, flow solver, "
          "limits of remeshing, folding, output and checkpoints may differ",
          "Put it back, or start without --resume");
    };
    for (const auto &[entry, value] : old_entries)
      if (matters(entry))
        {
          const auto found = new_entries.find(entry);
          if (found == new_entries.end())
            throw differs(entry, value, "(not there)");
          if (found->second != value && !same.count(entry))
            throw differs(entry, value, found->second);
        }
    for (const auto &[entry, value] : new_entries)
      if (matters(entry) && !old_entries.count(entry))
        throw differs(entry, "(not there)", value);
  }
} // namespace axiforge::process
