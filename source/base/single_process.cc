// SPDX-License-Identifier: GPL-2.0-or-later
#include <csignal>
#include <cstdlib>
#include <cstring>

#include <sys/syscall.h>
#include <unistd.h>

#include <axiforge/base/single_process.h>

namespace
{
  bool mpi_starts = false; // and has not come back yet

  void nobody_reads(int)
  {
    // The write fails, and that is enough.
  }
} // namespace


/// MPI_Init ends the process by _exit(1) if it fails, and no handler can be set before it. This
/// stands in for the function of the C library, and does the same at any other time.
extern "C" [[noreturn]] void _exit(int status)
{
  if (mpi_starts)
    {
      const char text[] = "axiforge: MPI could not be started; what it says about it stands above. "
                          "Nothing is wrong with the scene, and nothing was run.\n";
      [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, text, sizeof(text) - 1);
      status                                 = 3;
    }
  while (true)
    ::syscall(SYS_exit_group, status);
}


namespace axiforge
{
  void expect_single_process()
  {
    for (const char *launched : { "OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK" })
      if (std::getenv(launched))
        return;
    // The script of a batch job is no task of a step, and a step of one task is alone as well.
    const char *tasks = std::getenv("SLURM_STEP_NUM_TASKS");
    if (std::getenv("SLURM_PROCID") && tasks && std::strcmp(tasks, "1") != 0)
      return;
    setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
    setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
    setenv("OMPI_MCA_pml", "ob1", 0);
    setenv("OMPI_MCA_btl", "self", 0);
  }


  std::unique_ptr<dealii::Utilities::MPI::MPI_InitFinalize> start_mpi(int &argc, char **&argv)
  {
    expect_single_process();
    struct sigaction hang_up, pipe;
    sigaction(SIGHUP, nullptr, &hang_up);
    sigaction(SIGPIPE, nullptr, &pipe);
    mpi_starts = true;
    auto mpi   = std::make_unique<dealii::Utilities::MPI::MPI_InitFinalize>(argc, argv, 1);
    mpi_starts = false;
    if (pipe.sa_handler == SIG_DFL)
      pipe.sa_handler = nobody_reads;
    sigaction(SIGHUP, &hang_up, nullptr);
    sigaction(SIGPIPE, &pipe, nullptr);
    return mpi;
  }
} // namespace axiforge
