// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <future>

namespace axiforge
{
  /**
   * One job at a time beside the program, on a core that has nothing else to do; where there is but
   * one core the job is done in place. A job must neither communicate nor touch what the program
   * goes on to change. What it takes stands in its own row of --timing, and no Phase counts it.
   */
  class Background
  {
  public:
    /// Waits for the job before, and starts this one. @throws what the job before has thrown
    /// @param name of the row; must outlive the program (a literal)
    void start(const char *name, std::function<void()> job);

    /// Whether this process may use more than one core.
    static bool has_core();

    /// Until there is no job any more. @throws what it has thrown
    void wait();

  private:
    std::future<void> job; ///< its destructor waits
  };
} // namespace axiforge
