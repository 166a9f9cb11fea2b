// Whether the ranges of a log are metres and its headings radians: asks if most of them are what no 2D laser measures,
// or what no robot turns. Memory is constant. One check belongs to one thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/stream.hpp"

namespace gdtslam {

class UnitCheck {
 public:
  void add_ranges(const LaserScan& scan);
  void add_heading(double stamp_s, double heading_rad);
  [[nodiscard]] bool are_ranges_doubtful() const { return 2 * far_ > ranges_; }
  /// Questions for the user, a sentence each; empty if there is no doubt.
  [[nodiscard]] std::vector<std::string> questions() const;

 private:
  struct Heading {
    double stamp_s = 0.0;
    double angle_rad = 0.0;
  };
  std::uint64_t ranges_ = 0;  ///< finite and positive
  std::uint64_t far_ = 0;     ///< ranges beyond any laser's reach; each repetition of one constant is left out
  float last_far_m_ = 0.0F;
  std::optional<Heading> last_heading_;
  double turned_rad_ = 0.0;
  double turned_fast_rad_ = 0.0;  ///< in steps that are faster than any robot
  std::uint64_t fast_steps_ = 0;
};

}  // namespace gdtslam
