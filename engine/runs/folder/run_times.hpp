// Where the CPU time of a run goes: what all threads of the process spent, handed to one stage after the other, so that
// nothing falls between two. One object belongs to one thread.
#pragma once

#include <string>
#include <vector>

#include "engine/runs/mapping/stopwatch.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

class RunTimes {
 public:
  /// What was spent since the last call goes to the stage of that name, or to none.
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
  /// Since the object was made.
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
