// Where one stroke of the mount ends and the next begins. One object belongs to one thread.
#pragma once

#include <cmath>

namespace gdtslam {

class StrokeEnds {
 public:
  /// Takes the elevation of the next scan; true if it begins a new stroke.
  bool take(float elevation_rad) {
    if (!has_scan_) turning_rad_ = elevation_rad;
    has_scan_ = true;
    const float step = elevation_rad - turning_rad_;
    if (direction_ == 0 || step * static_cast<float>(direction_) >= 0.0F) {
      if (direction_ == 0 && std::fabs(step) > kTurnedBack_rad) direction_ = step > 0.0F ? 1 : -1;
      if (direction_ != 0) turning_rad_ = elevation_rad;
      return false;
    }
    if (std::fabs(step) <= kTurnedBack_rad) return false;
    direction_ = -direction_;
    turning_rad_ = elevation_rad;
    return true;
  }

  /// True if the elevation rises in the current stroke, as far as is known.
  [[nodiscard]] bool is_upward() const { return direction_ >= 0; }

 private:
  /// A stroke has ended when the elevation is this far behind its furthest.
  static constexpr float kTurnedBack_rad = 0.05F;
  bool has_scan_ = false;
  float turning_rad_ = 0.0F;  // elevation of the farthest scan of this stroke
  int direction_ = 0;
};

}  // namespace gdtslam
