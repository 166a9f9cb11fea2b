// A rigid motion in space, and the tree of frames. Metres. Thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Points of the child in the parent.
struct Transform3 {
  std::array<double, 9> rotation{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};  ///< row-major
  std::array<double, 3> shift_m{};
  [[nodiscard]] bool is_finite() const;
};
Transform3 operator*(const Transform3& a, const Transform3& b);
/// The pose seen from above: position, and the direction of the x axis. An angle within 2e-15 rad of one of nine
/// decimals, the loss of a quaternion, is rounded to it.
Pose2 seen_from_above(const Transform3& transform);

/// The namespace of a robot before a frame's name: "robot1/" in "robot1/base_link".
std::string_view frame_namespace(std::string_view frame);
std::string_view name_in_namespace(std::string_view frame);
/// True for a usual name of a frame of odometry: odom, robot1/odom, odom_combined, camera_odom_frame.
bool is_odometry_frame(std::string_view frame);

/// The tree of static frames; keeps at most kMostFrames.
class FrameTree {
 public:
  static constexpr std::size_t kMostFrames = 4096;
  void add(const std::string& parent, const std::string& child, const Transform3& T_parent_child);
  /// The transform from a frame up to `base`, or to one with a usual name of a base if `base` is empty. A frame that is
  /// not in the tree is searched in the namespace of `base`.
  [[nodiscard]] std::optional<Transform3> find(const std::string& frame, const std::string& base) const;
  /// The frames on the way, with both ends; empty if there is no way.
  [[nodiscard]] std::vector<std::string> chain(const std::string& frame, const std::string& base) const;
  /// "laser in plate, plate in base": for messages, at most a dozen.
  [[nodiscard]] std::string text() const;

 private:
  struct Edge {
    std::string parent;
    Transform3 T_parent_child;
  };
  std::map<std::string, Edge, std::less<>> edges_;  ///< by child
};

}  // namespace gdtslam
