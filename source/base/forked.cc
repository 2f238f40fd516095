// SPDX-License-Identifier: GPL-2.0-or-later
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <axiforge/base/forked.h>

namespace axiforge
{
  namespace
  {
    constexpr int came_to_its_end = 77; // a library that ends the process says something else

    [[noreturn]] void do_quietly(const std::function<void()> &action)
    {
      // MPI's handlers would print pages about a crash.
      for (const int signal : { SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGBUS, SIGTERM, SIGINT, SIGHUP })
        std::signal(signal, SIG_DFL);
      const struct rlimit no_core = { 0, 0 };
      setrlimit(RLIMIT_CORE, &no_core);
      const int nowhere = ::open("/dev/null", O_RDWR);
      for (int stream = 0; stream < 3 && nowhere >= 0; ++stream)
        dup2(nowhere, stream);
      try
        {
          action();
        }
      catch (...) // the parent meets it again, and can say it
        {
        }
      _exit(came_to_its_end);
    }
  } // namespace

  std::string fate_of(const std::function<void()> &action)
  {
    const pid_t child = fork();
    if (child < 0)
      return "";
    if (child == 0)
      do_quietly(action);
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
      if (errno != EINTR)
        return "";
    if (WIFSIGNALED(status))
      return WTERMSIG(status) == SIGKILL
                 ? "was killed, probably for want of memory,"
                 : std::string("crashed (") + strsignal(WTERMSIG(status)) + ")";
    return WEXITSTATUS(status) == came_to_its_end ? "" : "ended the process";
  }
} // namespace axiforge
