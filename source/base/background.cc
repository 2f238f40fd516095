// SPDX-License-Identifier: GPL-2.0-or-later
#include <thread>

#include <axiforge/base/background.h>
#include <axiforge/base/phases.h>

namespace axiforge
{
  void Background::start(const char *name, std::function<void()> work)
  {
    wait();
    if (std::thread::hardware_concurrency() < 2)
      {
        const Phase phase(name);
        return work();
      }
    job = std::async(std::launch::async, [name, work = std::move(work)] {
      const Phase::Beside beside(name);
      work();
    });
  }


  void Background::wait()
  {
    if (job.valid())
      job.get();
  }
} // namespace axiforge
