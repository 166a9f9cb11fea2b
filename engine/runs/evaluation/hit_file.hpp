// The true hits that `simulate --truth-hits` writes (docs/simulation.md), row by row: the format and nothing else.
// Memory does not depend on the number of rows. One object belongs to one thread.
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace gdtslam {

/// What one returned beam really met; frame of the scene.
struct TrueHit {
  Eigen::Vector3d place_m{0.0, 0.0, 0.0};
  double stamp_s = 0.0;  ///< when the beam was fired
  double range_m = 0.0;  ///< from the sensor
  std::uint32_t scan = 0;
};

class HitReader {
 public:
  /// Throws FileError, or InputError for a file that is none of those, cut off or too long.
  explicit HitReader(const std::string& path);
  /// Nothing at the end. Throws InputError.
  std::optional<TrueHit> next();
  [[nodiscard]] std::uint64_t hits() const { return hits_; }

 private:
  std::string path_;
  std::ifstream file_;
  std::uint64_t hits_ = 0;
  std::uint64_t read_ = 0;
};

}  // namespace gdtslam
