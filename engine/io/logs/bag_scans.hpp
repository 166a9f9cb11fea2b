// From the messages of a bag to scans with odometry: where the laser sits, which way its beams go, and where the
// wheels were at the scan's stamp. Frames: laser, base (the child of the odometry), odom. Not thread-safe; memory is
// bounded: kMostHeldScans scans wait for odometry, kMostPoses poses and kMostEdges frames are kept.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "bag_messages.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {

inline constexpr std::size_t kMostHeldScans = 64;
inline constexpr std::size_t kMostPoses = 4096;
inline constexpr std::size_t kMostEdges = 4096;

/// How frames lie to each other, as far as they do not move.
class FrameTree {
 public:
  void add(const BagTransform& edge);
  /// From a frame up to another one, or to one that is called as robots' bases are where `base` is empty.
  [[nodiscard]] std::optional<Transform3> find(const std::string& frame, const std::string& base) const;

 private:
  struct Edge {
    std::string parent;
    Transform3 T_parent_child;
  };
  std::map<std::string, Edge, std::less<>> edges_;  ///< by child
};

class BagScans {
 public:
  using Warn = std::function<void(std::string_view kind, const std::string& detail)>;
  BagScans(const ReadOptions& options, Warn warn) : options_(options), warn_(std::move(warn)) {}

  void add(BagScan scan) { waiting_.push_back(std::move(scan)); }
  /// Of an odometry topic, which counts for more than transforms.
  void add_odometry(const BagTransform& pose);
  /// A transform from a frame called odom... is odometry; all others say how frames lie to each other.
  void add_transform(const BagTransform& transform);
  /// The next scan whose odometry and mount are known: there is a pose behind it, too many wait, or it is the end.
  std::optional<ScanRecord> next(bool at_end);

 private:
  enum class PoseSource : std::uint8_t { kUnknown, kOdometry, kTransforms };
  void add_pose(const BagTransform& pose);
  [[nodiscard]] std::optional<Pose2> odometry_at(double stamp_s) const;
  [[nodiscard]] bool is_mount_known(const std::string& frame) const;
  [[nodiscard]] const Transform3& mount_of(const std::string& frame);
  [[nodiscard]] ScanRecord record_of(BagScan scan);

  ReadOptions options_;
  Warn warn_;
  PoseSource source_ = PoseSource::kUnknown;
  std::string base_;
  std::deque<BagScan> waiting_;
  std::deque<Odometry> poses_;
  FrameTree frames_;
  std::map<std::string, Transform3, std::less<>> mounts_;  ///< of each frame that scans have
};

}  // namespace gdtslam
