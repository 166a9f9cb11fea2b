// Work in processes of its own, several at a time: what measures its CPU time measures nothing else, and a graphics
// driver that fails takes one piece of work with it and not the rest. The processes are forks, so that whoever uses
// this must not have started threads or opened a device. One object belongs to one thread. Linux.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

class Workers {
 public:
  /// Takes the share of the work that is done.
  using Tell = std::function<void(double)>;
  /// The work of the process; its result comes back as Event::result, its exception as Event::failure.
  using Work = std::function<std::string(const Tell&)>;
  /// Why work ended without a result.
  struct Failure {
    ExitCode code = ExitCode::kFailed;
    std::string message;
    bool by_signal = false;   ///< the process was ended from without, or broke
    bool for_memory = false;  ///< there was not enough
  };
  struct Event {
    std::size_t id = 0;
    double share = 0.0;
    double cpu_s = 0.0;                 ///< CPU time of the process, once it ended
    std::optional<std::string> result;  ///< empty while it works, or if it failed
    std::optional<Failure> failure{};   ///< why it ended without a result
  };

  explicit Workers(unsigned most) : most_(most) {}
  /// Stops running processes (SIGTERM, see console.hpp) and waits for them.
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  [[nodiscard]] bool is_full() const { return running_.size() >= most_; }
  [[nodiscard]] bool is_idle() const { return running_.empty(); }
  /// Throws Error where there is no further process.
  void start(std::size_t id, const Work& work);
  /// The next event of any process, also that it failed; only if not idle. Throws Error(kInterrupted) when the program
  /// is interrupted.
  Event wait_for_any();

 private:
  struct Process {
    std::size_t id = 0;
    pid_t pid = 0;
    int pipe = -1;
    std::string text{};     ///< read, and no whole line yet
    std::string outcome{};  ///< the line that tells it; empty: it works
    double share = 0.0;
  };
  static void take_lines(Process& process);
  static Event make_event(const Process& process, double cpu_s, int status);
  Event ended(std::size_t place);

  unsigned most_;
  std::vector<Process> running_;
};

}  // namespace gdtslam
