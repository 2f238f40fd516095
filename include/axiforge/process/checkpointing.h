// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include <deal.II/base/timer.h>

#include <axiforge/output/results.h>
#include <axiforge/scene/scene.h>
#include <axiforge/state/checkpoint.h>

namespace axiforge::process
{
  /**
   * When a run writes its checkpoint: as the scene says, when it cannot go on, on SIGUSR1, and on
   * SIGTERM, SIGINT, SIGHUP and SIGPIPE, which end it after the present step. The signals are
   * caught as long as the object is there; a second SIGTERM, SIGINT or SIGHUP ends the program at
   * once. A signal that is ignored at the start stays ignored (nohup).
   *
   * The file is `checkpoint.axi` in the folder of the results; the one before it stays as
   * `checkpoint.old.axi`.
   */
  class Checkpointing
  {
  public:
    /// @param folder of the results, @param parameters text of all entries in effect
    Checkpointing(const std::string &folder, const std::string &parameters);
    Checkpointing(const Checkpointing &) = delete;
    ~Checkpointing();

    /// From now on checkpoints are of this operation. The arguments have to stay.
    void enter(const scene::Scene &scene, const ChainProgress &chain, output::Results &results);

    /**
     * After an accepted step whose row is written: writes if it is due. Collective.
     * @return whether it has written because of a signal
     * @throws ComputationError if a signal asks the run to stop
     */
    bool after_step(const State &state, const StepRecord &record);

    /// At the end of an operation, if the scene asks for checkpoints or another one follows.
    /// Collective.
    void at_end(const State &state, const StepRecord &record);

    /**
     * When the run cannot go on: writes the last good state, to be called before other results are
     * written. Throws nothing. Collective.
     * @return a sentence for the message that says how to continue; empty if there was no step
     */
    std::string rescue(const State &state, const StepRecord &record) noexcept;

    /// Whether operations follow the present one; set by who runs the chain.
    bool more_follow = false;

  private:
    void write(const State &state, const StepRecord &record);

    std::string          folder, parameters;
    const scene::Scene  *scene   = nullptr;
    const ChainProgress *chain   = nullptr;
    output::Results     *results = nullptr;
    dealii::Timer        since_last;
    unsigned int         last_step = static_cast<unsigned int>(-1); ///< of the last checkpoint
    std::string          last_kept; ///< what the last checkpoint is of, in words
  };

  /// Whether a signal has asked the last run to stop, on any rank. Collective.
  bool stopped_by_signal(MPI_Comm communicator);

  /**
   * Where --resume finds its checkpoint.
   * @param from as given: folder, file or empty
   * @param folder of the results of this run
   * @return path of the file
   * @throws InputError if it is in another folder than that of the results
   */
  std::string find_checkpoint(const std::string &from, const std::string &folder);

  /**
   * Checks that a checkpoint belongs to a scene: all entries are the same but for the end of the
   * run, time stepping, flow solver, outputs and checkpoints. Operations that have not begun may
   * differ altogether. Files are the same if their contents are.
   * @param before, now texts of all entries in effect, with the fingerprints of the files
   * @param begun names of the operations that have begun
   * @throws InputError that names the first entry that differs
   */
  void check_same_scene(const std::string              &before,
                        const std::string              &now,
                        const std::vector<std::string> &begun,
                        const std::string              &path);
} // namespace axiforge::process
