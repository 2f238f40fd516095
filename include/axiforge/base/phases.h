// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

namespace axiforge
{
  /**
   * Where the time of a run goes: phases that hold other phases. A Phase lasts as long as it is in
   * scope; phases with the same name inside the same one are added up. A phase that is never
   * entered is in no table. Until measure_phases() is called a Phase costs the test of one flag.
   *
   * For the thread that runs the program; the times are those of this rank.
   */
  class Phase
  {
  public:
    /// @param name must outlive the program (a literal)
    explicit Phase(const char *name)
    {
      if (measured)
        enter(name);
    }

    ~Phase()
    {
      if (measured)
        leave();
    }

    Phase(const Phase &)            = delete;
    Phase &operator=(const Phase &) = delete;

    /// From now on; what went before is in no phase.
    static void measure_phases();

    /// Table in Markdown, one row for each phase in the order of the first entry: calls, wall and
    /// CPU seconds (with the phases inside), share of the whole, and the part that is in none of
    /// the phases inside. Empty before measure_phases().
    static std::string table();

  private:
    static void enter(const char *name);
    static void leave();

    static bool measured;
  };
} // namespace axiforge
