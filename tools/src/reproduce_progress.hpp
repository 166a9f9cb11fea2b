// The line on standard error while `gdtslam reproduce` works: part, share, time left; without a terminal one line for
// each finished part. The time left is that of the parts' weights, at the speed of what is done so far. One thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace gdtslam::reproduce {

class Progress {
 public:
  /// `total_s`: weights of all parts to be made.
  Progress(std::size_t parts, double total_s, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void begin(const std::string& label, double weight_s);
  /// Share of the part in hand.
  void update(double share);
  /// The part in hand is done.
  void finish(double seconds);
  void clear();

  /// "fig14 (3 of 10)  42 %  1:10 min left".
  static std::string text(const std::string& label, std::size_t number, std::size_t parts, double share, double left_s);

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] double left_s(double share) const;

  std::size_t parts_;
  std::size_t number_ = 0;
  double total_s_;
  double done_s_ = 0.0;
  double weight_s_ = 0.0;
  bool quiet_;
  bool is_terminal_;
  bool drawn_ = false;
  std::string label_;
  Clock::time_point start_;
  Clock::time_point last_;
};

}  // namespace gdtslam::reproduce
