// Several lasers of one robot take turns, or scan at the same time. The scans of one period are one observation of one
// pose: together they see all directions at each step, while scans matched one by one see a different direction each
// time. An observation holds at most one scan of each laser. The log alone decides which scans belong together, so a
// live run and a later one agree. Seconds. Not thread-safe; constant time a scan.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/runs/motion/scan_speed.hpp"
#include "engine/runs/streams/odometry_delay.hpp"
#include "engine/runs/streams/unit_check.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/runs/outcome.hpp"

namespace gdtslam {

/// Scans in log order, at least one. The last one's stamp is that of the observation.
using Observation = std::vector<ScanRecord>;

/// Collects scans until each active laser has given one. An observation also ends if a laser comes again, if it would
/// last kLongest_s, and before a scan of the laser with the longest pause before its scans. So scans that are close in
/// time stay together. With one laser each scan is an observation at once.
class ObservationCollector {
 public:
  static constexpr double kLongest_s = 1.0;
  static constexpr std::size_t kMostLasers = 64;
  /// A laser stays active for this many observations after its last scan.
  static constexpr std::uint64_t kActiveObservations = 5;

  void take(ScanRecord scan);
  /// The log ends: lasers of the next one may have other numbers.
  void end_log();
  /// The next observation that is complete; with `at_end` also the one that is being collected.
  std::optional<Observation> next(bool at_end);

 private:
  struct Laser {
    std::uint64_t last_observation = 0;
    std::optional<double> gap_s;  ///< mean time from the previous scan of any laser to a scan of this laser
  };
  [[nodiscard]] bool is_active(const Laser& laser) const;
  [[nodiscard]] bool has_scan_from(std::size_t laser) const;
  [[nodiscard]] bool has_room_for(const ScanRecord& scan) const;
  [[nodiscard]] bool is_complete() const;
  Laser& find_laser(std::size_t number);
  void finish();
  void choose_first();

  Observation scans_;  ///< being collected
  std::deque<Observation> ready_;
  std::vector<std::pair<std::size_t, Laser>> lasers_;  ///< with their numbers
  std::optional<std::size_t> first_;                   ///< laser with the longest pause before its scans
  std::optional<double> last_stamp_s_;
  std::uint64_t count_ = 0;  ///< number of observations
};

// The scans of one or more logs in order, each with the odometry that belongs to it. A scan's own odometry counts if
// its line has one; else it is interpolated between the odometry records around it. Each later log continues at the end
// of the previous one: its odometry is moved so that its first pose is the last one of the previous log. Frames: robot
// in the odometry frame of the first log. One stream belongs to one thread; memory does not depend on the length of the
// logs.

/// The log as messages name it: "-" is the standard input.
std::string log_name(const std::string& path);

/// Sets the times of the beams if they are stated; all at the scan's stamp if scans are not deskewed.
void state_beam_times(const ReadOptions& options, LaserScan& scan);

/// Along the circular arc from a to b; the share is that of the time between them. Returns `a` if the clock stood still
/// or went backward.
Pose2 interpolated(const Odometry& a, const Odometry& b, double stamp_s);

/// Gives scans without odometry the pose between the odometry records before and after them in the log. Scans before
/// the first odometry record have no pose. At most kMostHeld scans wait for the next record.
class OdometryInterpolator {
 public:
  static constexpr std::size_t kMostHeld = 64;
  void take(const Odometry& odometry);
  void take(ScanRecord scan);
  /// The next complete scan; with `at_end` also waiting scans.
  std::optional<ScanRecord> next(bool at_end);

 private:
  std::optional<Odometry> last_;
  std::deque<ScanRecord> waiting_;
  std::deque<ScanRecord> ready_;
};

class ScanStream {
 public:
  /// Opens the log of that number, counted from 0, another way than by its path; empty: by its path.
  using OpenLog = std::function<std::unique_ptr<LogReader>(std::size_t log)>;
  /// Opens the first log. Throws InputError or FileError, as next() does; once a log could not be opened, next() always
  /// throws that.
  ScanStream(std::vector<std::string> paths, const ReadOptions& options, const ScanRange& range, OpenLog open = {});

  std::optional<ScanRecord> next();
  /// The scans of the next observation, all of one log. An exception of next() comes after the scans before it. Call
  /// either this or next(), not both.
  std::optional<Observation> next_observation();
  /// Looks ahead for a message of a mount, up to `scans_ahead` scans of the first log. The fault of a record on the way
  /// is thrown when next() reaches it, or by expect_readable().
  NodKind nod_kind(std::size_t scans_ahead = kScansAhead);
  void expect_readable() const {
    if (ahead_problem_) std::rethrow_exception(ahead_problem_);
  }
  static constexpr std::size_t kScansAhead = 20;
  static constexpr std::size_t kMostAhead = 10000;  ///< records
  /// Kind of the warning if a nodding laser is mapped as a level one.
  static constexpr std::string_view kUnusedNods = "nodding message not used";
  /// `record` gets every record but the scans, in log order and before the next scan is given, and returns whether it
  /// could use it. `next_log` is called for each log after the first, once all scans of the previous one have been
  /// given.
  struct Listener {
    std::function<bool(const LogRecord&)> record;
    std::function<void()> next_log;
  };
  void set_listener(Listener listener) { listener_ = std::move(listener); }
  /// After the last wanted scan: gives the listener one more record of the current log. False at its end.
  bool feed_listener();
  /// Share of the wanted scans or of the input, the larger of the two; negative when unknown.
  [[nodiscard]] double progress() const;
  /// States how much later odometry is stamped than its scans. Call before the first scan is taken.
  void set_odometry_delay(double delay_s) { shift_.emplace(delay_s); }
  /// Sets the times of beams that these options state.
  void set_beam_times(const ReadOptions& options) {
    options_.first_beam_after_s = options.first_beam_after_s;
    options_.beam_period_s = options.beam_period_s;
  }
  /// Scans read so far, including those left out at the start.
  [[nodiscard]] std::uint64_t scans_read() const { return read_; }
  /// Warnings of all logs so far, by kind.
  [[nodiscard]] std::vector<LogReader::Warning> warnings() const;
  /// Questions about the units of the given scans.
  [[nodiscard]] std::vector<std::string> questions_of_units() const { return units_.questions(); }

 private:
  std::optional<LogRecord> next_record();
  void notify_listener(const LogRecord& record);
  std::optional<ScanRecord> next_with_odometry();
  std::optional<ScanRecord> next_shifted();
  std::optional<ScanRecord> next_of_all();
  void open_next();
  void connect(std::optional<Pose2>& T_odom_base);

  std::vector<std::string> paths_;
  ReadOptions options_;
  ScanRange range_;
  OpenLog open_;
  std::size_t opened_ = 0;
  std::unique_ptr<LogReader> reader_;  ///< null once all logs are read
  std::exception_ptr open_problem_;    ///< problem with the log after it
  OdometryInterpolator interpolator_;
  OdometrySpeed speed_;
  UnitCheck units_;
  std::optional<OdometryShift> shift_;
  ObservationCollector observations_;
  std::exception_ptr problem_;  ///< thrown after the scans of observations_
  std::deque<LogRecord> ahead_;
  std::exception_ptr ahead_problem_;  ///< thrown after the records of ahead_
  Listener listener_;
  std::vector<LogReader::Warning> earlier_warnings_;
  LogReader::Warning unused_{std::string(kUnusedNods), 0, ""};
  std::uint64_t read_ = 0;
  std::uint64_t given_ = 0;
  bool skipped_ = false;
  std::optional<Pose2> T_odom_base_last_;  ///< odometry of the previous scan, in the frame of the first log
  std::optional<Pose2> T_first_this_;      ///< from this log's odometry frame to that of the first
};

/// Merges warnings of several readers into one list by kind: adds the counts. A kind that the list has keeps its
/// example.
inline void merge_warnings(std::vector<LogReader::Warning>& list, const std::vector<LogReader::Warning>& more) {
  for (const LogReader::Warning& warning : more) {
    const auto same =
        std::find_if(list.begin(), list.end(), [&warning](const auto& known) { return known.kind == warning.kind; });
    if (same == list.end()) {
      list.push_back(warning);
    } else {
      same->count += warning.count;
    }
  }
}

// A signal may cut an input anywhere: in the middle of a line, or before the named topics.

/// The next record of `source`. If `stop` returns true, a reader's exception counts as the end.
template <class Source>
auto next_unless_stopped(Source& source, const std::function<bool()>& stop) {
  try {
    return source.next();
  } catch (const InputError&) {
    if (!stop()) throw;
  } catch (const MissingTopic&) {
    if (!stop()) throw;
  }
  return decltype(source.next())();
}

}  // namespace gdtslam
