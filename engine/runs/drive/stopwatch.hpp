// Wall and CPU time since the last reading, without gaps between readings. One watch belongs to one thread; the CPU
// time is that of all threads of the process.
#pragma once

#include <chrono>
#include <ctime>
#include <string>
#include <vector>

#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

class Stopwatch {
 public:
  void add_to(double& wall_s) {
    double unused_s = 0.0;
    add_to(wall_s, unused_s);
  }
  void add_cpu_to(double& cpu_s) {
    double unused_s = 0.0;
    add_to(unused_s, cpu_s);
  }
  void add_to(double& wall_s, double& cpu_s) {
    const Clock::time_point now = Clock::now();
    const double cpu_now_s = process_cpu_s();
    wall_s += std::chrono::duration<double>(now - start_).count();
    cpu_s += cpu_now_s - cpu_start_s_;
    start_ = now;
    cpu_start_s_ = cpu_now_s;
  }

 private:
  using Clock = std::chrono::steady_clock;

  static double process_cpu_s() {
    timespec time{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  Clock::time_point start_ = Clock::now();
  double cpu_start_s_ = process_cpu_s();
};

// CPU time of a run by stage, for all threads of the process, without gaps between stages. One object belongs to one
// thread.

class RunTimes {
 public:
  /// Adds the time since the last call to the stage of that name, or to none.
  void add(const char* name) {
    StageTime stage{name, 0.0};
    watch_.add_cpu_to(stage.cpu_s);
    stages_.push_back(std::move(stage));
  }
  void skip() {
    double elsewhere_s = 0.0;
    watch_.add_cpu_to(elsewhere_s);
  }
  [[nodiscard]] const std::vector<StageTime>& stages() const { return stages_; }
  /// Reads the times since construction.
  void read_whole(double& wall_s, double& cpu_s) const {
    Stopwatch whole = whole_;
    wall_s = cpu_s = 0.0;
    whole.add_to(wall_s, cpu_s);
  }

 private:
  Stopwatch whole_;
  Stopwatch watch_;
  std::vector<StageTime> stages_;
};

}  // namespace gdtslam
