// SPDX-License-Identifier: GPL-2.0-or-later
#include <sched.h>

#include <axiforge/base/background.h>
#include <axiforge/base/phases.h>

namespace axiforge
{
  void Background::start(const char *name, std::function<void()> work)
  {
    wait();
    if (has_core())
      job = std::async(std::launch::async, [name, work = std::move(work)] {
        const Phase::Beside beside(name);
        work();
      });
    else
      {
        job = std::async(std::launch::deferred, [name, work = std::move(work)] {
          const Phase phase(name);
          work();
        });
        job.wait(); // does it, and keeps what it throws
      }
  }


  bool Background::has_core()
  {
    cpu_set_t cores;
    return sched_getaffinity(0, sizeof(cores), &cores) == 0 && CPU_COUNT(&cores) > 1;
  }


  void Background::wait()
  {
    if (job.valid())
      job.get();
  }
} // namespace axiforge
