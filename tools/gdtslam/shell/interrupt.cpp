#include "interrupt.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace gdtslam {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;
int g_empty_input = -1;

// A read that is blocked on standard input returns, is tried again and then finds the end of the file.
extern "C" void on_interrupt(int /*signal*/) {
  const int saved_errno = errno;
  g_interrupted = 1;
  if (g_empty_input >= 0) ::dup2(g_empty_input, STDIN_FILENO);
  errno = saved_errno;
}

}  // namespace

void install_interrupt_handlers() {
  g_empty_input = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // no SA_RESTART; the second signal has its default effect
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  // A terminal that goes away sends SIGHUP twice, by the kernel and by the shell, so the second must not end the
  // process. Whoever started it with nohup wants none at all.
  action.sa_flags = 0;
  struct sigaction inherited {};
  if (::sigaction(SIGHUP, nullptr, &inherited) == 0 && inherited.sa_handler != SIG_IGN) {
    ::sigaction(SIGHUP, &action, nullptr);
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupted() { return g_interrupted != 0; }

}  // namespace gdtslam
