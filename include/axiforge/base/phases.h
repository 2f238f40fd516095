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
   * For the thread that runs the program; the times are those of this rank. CPU time is that of the
   * process (threads of libraries count) less what runs beside the program (Beside).
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

    /// Work on another thread, for as long as it is in scope. There is one at a time. Its time is
    /// in no phase but in a row of its own at the end of the table, and in the CPU time of the
    /// whole.
    class Beside
    {
    public:
      explicit Beside(const char *name);
      ~Beside();

      Beside(const Beside &)            = delete;
      Beside &operator=(const Beside &) = delete;

      struct Row;

    private:
      Row *row = nullptr; ///< none without measure_phases()
    };

    /// From now on; what went before is in no phase.
    static void measure_phases();

    /// Table in Markdown, one row for each phase in the order of the first entry: calls, wall and
    /// CPU seconds (with the phases inside), share of the whole, and the part that is in none of
    /// the phases inside; then what ran beside. Empty before measure_phases().
    static std::string table();

  private:
    static void enter(const char *name);
    static void leave();

    static bool measured;
  };
} // namespace axiforge
