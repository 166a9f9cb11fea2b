// Work in several processes at a time. The CPU time of a process measures its work alone, and a failing graphics driver
// ends one piece of work and not the rest. The processes are forks: use this before starting threads or opening a
// device. One object belongs to one thread. Linux.
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
  /// Receives the share of the work that is done.
  using Tell = std::function<void(double)>;
  /// Runs in the process; its result arrives as Event::result, its exception as Event::failure.
  using Work = std::function<std::string(const Tell&)>;
  /// Reason why work ended without a result.
  struct Failure {
    ExitCode code = ExitCode::kFailed;
    std::string message;
    bool by_signal = false;   ///< the process was killed or crashed
    bool for_memory = false;  ///< memory ran out
  };
  struct Event {
    std::size_t id = 0;
    double share = 0.0;
    double cpu_s = 0.0;                 ///< CPU time of the process, set when it has ended
    std::optional<std::string> result;  ///< empty while it runs, or if it failed
    std::optional<Failure> failure{};   ///< set if it ended without a result
  };

  explicit Workers(unsigned most) : most_(most) {}
  /// Stops running processes (SIGTERM, see console.hpp) and waits for them.
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  [[nodiscard]] bool is_full() const { return running_.size() >= most_; }
  [[nodiscard]] bool is_idle() const { return running_.empty(); }
  /// Throws Error if the system gives no further process.
  void start(std::size_t id, const Work& work);
  /// Next event of any process, failures included; call it only if not idle. Throws Error(kInterrupted) if the program
  /// is interrupted.
  Event wait_for_any();

 private:
  struct Process {
    std::size_t id = 0;
    pid_t pid = 0;
    int pipe = -1;
    std::string text{};     ///< read, but no whole line yet
    std::string outcome{};  ///< line with the outcome; empty: still running
    double share = 0.0;
  };
  static void take_lines(Process& process);
  static Event make_event(const Process& process, double cpu_s, int status);
  Event ended(std::size_t place);

  unsigned most_;
  std::vector<Process> running_;
};

}  // namespace gdtslam
