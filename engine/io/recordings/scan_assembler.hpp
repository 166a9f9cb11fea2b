// Assembles scans with odometry from the messages of a recording: mount of each laser, direction of its beams, and
// odometry at the scan's stamp. Scans of several lasers are sorted by stamp; messages of a nodding mount's crank come
// between them. Frames: laser, base (the child of the odometry), odom. Not thread-safe; memory is bounded:
// kMostHeldScans scans wait for odometry, kMostHeldNumbers messages of a crank with them, OdometryTrack keeps poses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/io/log_contents.hpp"
#include "gdtslam/core/stream.hpp"
#include "messages.hpp"
#include "odometry_track.hpp"
#include "stamps.hpp"
#include "transform3.hpp"

namespace gdtslam {

/// The source of odometry in --odom: a topic, or tf[:FRAME[:BASE]], the transform between these frames.
struct OdometryChoice {
  std::string topic{};
  std::string frame{};
  std::string base{};
  explicit OdometryChoice(const std::string& text);
  [[nodiscard]] bool is_transform() const { return topic == kTransformTopic; }
};

class ScanAssembler {
 public:
  static constexpr std::size_t kMostHeldScans = 64;
  static constexpr std::size_t kMostHeldNumbers = 4096;

  using Warn = std::function<void(std::string_view kind, const std::string& detail)>;
  ScanAssembler(const ReadOptions& options, Warn warn);

  /// A laser's number for the scans of a topic; call once for each topic, in the order of their first scans.
  std::size_t add_laser(const std::string& topic);
  void add_scan(std::size_t laser, ScanMessage scan, double received_s);
  /// Takes a message of an odometry topic, which is preferred to transforms.
  void add_odometry(const TransformMessage& pose, double received_s);
  /// A transform from an odometry frame, or from the chosen one, is odometry unless it is static; all others go to the
  /// tree of frames. Returns whether it was used as odometry.
  bool add_transform(const TransformMessage& transform, double received_s, bool is_static = false);
  /// A joint's message has a header; a number's has none, and its stamp is that of its receipt.
  void add_crank(const NumberMessage& number, double received_s, bool has_header = true);
  /// The next complete record. A scan is complete if its odometry, its mount and earlier scans of other lasers are
  /// known, if too many scans wait, or at the end.
  std::optional<LogRecord> next(bool at_end);

  // Findings so far, for reports.
  [[nodiscard]] bool has_odometry() const { return !poses_.empty(); }
  [[nodiscard]] const std::string& odometry_frame() const { return odometry_frame_; }
  [[nodiscard]] const std::string& base_frame() const { return base_; }
  [[nodiscard]] std::string frames_text() const { return frames_.text(); }
  /// The shift added to stamps; none before it is settled.
  [[nodiscard]] std::optional<double> odometry_shift_s() const { return pose_shift_s_; }
  [[nodiscard]] std::optional<double> crank_shift_s() const { return crank_shift_s_; }
  /// The frame of the laser's scans and the source of its mount; topic stays empty.
  [[nodiscard]] LaserContents laser_contents(std::size_t laser) const;

 private:
  /// kUnknown: transforms until odometry arrives.
  enum class PoseSource : std::uint8_t { kUnknown, kOdometry, kTransforms };
  struct Laser {
    std::optional<Pose2> T_base_laser;  ///< stated
    std::string frame{};                ///< frame of its last scan
    double last_stamp_s = 0.0;
    FirstStamp<ScanMessage> stamps{};
  };
  struct HeldScan {
    std::size_t laser = 0;
    ScanMessage scan;
    std::uint64_t stretch = 0;  ///< stretch of the odometry's clock
    std::uint64_t due = 0;      ///< number of poses that it waits for
  };
  using Held = std::variant<HeldScan, NumberMessage>;
  /// A number that keeps its place in the queue until its stamp is known.
  struct WaitingStamp {
    double stamp_s = 0.0;
    NumberMessage* number = nullptr;
  };

  void start_odometry();
  [[nodiscard]] int fit_to_laser(const std::string& odometry, const std::string& base) const;
  void add_pose(const TransformMessage& pose, double received_s);
  void take_scan(std::size_t laser, ScanMessage scan, double received_s);
  void take_pose(const Odometry& pose, double received_s);
  /// Receivers of messages with known stamps.
  auto scan_taker(std::size_t laser);
  auto pose_taker();
  auto crank_taker();
  void settle_stamps();
  void place_held_scans();
  [[nodiscard]] bool is_clock_known(bool must_go);
  [[nodiscard]] double measure_shift(const TopicClock& clock, std::string_view what);
  [[nodiscard]] bool is_complete(const HeldScan& held) const;
  [[nodiscard]] std::optional<Pose2> odometry_at(std::uint64_t stretch, double stamp_s) const;
  void warn_of_tilt(const std::string& frame, const Transform3& mount);
  [[nodiscard]] const Transform3& find_mount(const std::string& frame);
  [[nodiscard]] ScanRecord make_record(HeldScan held);
  [[nodiscard]] LogRecord make_record(const NumberMessage& number) const;

  ReadOptions options_;
  OdometryChoice choice_;
  Warn warn_;
  PoseSource source_ = PoseSource::kUnknown;
  std::string odometry_frame_;
  std::string base_;
  std::vector<Laser> lasers_;
  std::list<Held> waiting_;  ///< a list, because elements must not move when others are inserted
  std::size_t held_scans_ = 0;
  OdometryTrack poses_;  ///< in the odometry's own clock
  std::uint64_t poses_taken_ = 0;
  FirstStamp<Odometry> pose_stamps_;
  FirstStamp<WaitingStamp> crank_stamps_;
  TopicClock scan_clock_;
  TopicClock pose_clock_;
  TopicClock crank_clock_;
  std::optional<double> pose_shift_s_;  ///< from the odometry's clock to the laser's, once it is settled
  std::optional<double> crank_shift_s_;
  FrameTree frames_;
  std::map<std::string, Transform3, std::less<>> mounts_;    ///< by the frames of scans
  std::set<std::string, std::less<>> frames_without_mount_;  ///< frames of scans whose transform did not come in time
};

}  // namespace gdtslam
