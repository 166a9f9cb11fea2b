// Several lasers of one robot take turns, or scan at the same time. The scans of one period are one observation of one
// pose: together they look all ways at each step, while scans matched one by one look a different way each time. An
// observation holds at most one scan of each laser. Which scans belong together follows from the log alone, so a live
// run and a later one agree. Seconds. Not thread-safe; constant time a scan.
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

/// Collects scans until each laser that is active has given one. An observation also ends where a laser comes again,
/// where it would last kLongest_s, and before the laser with the longest pause before its scans, so that scans that
/// are close in time stay together. With one laser each scan is an observation at once.
class ObservationCollector {
 public:
  static constexpr double kLongest_s = 1.0;
  static constexpr std::size_t kMostLasers = 64;
  /// A laser is active for so many observations after its last scan.
  static constexpr std::uint64_t kActiveObservations = 5;

  void take(ScanRecord scan);
  /// The log ends: lasers of the next one may have other numbers.
  void end_log();
  /// The next observation that is complete; with `at_end` also the one that is being collected.
  std::optional<Observation> next(bool at_end);

 private:
  struct Laser {
    std::uint64_t last_observation = 0;
    std::optional<double> gap_s;  ///< mean time from the scan before, of whichever laser, to one of this laser
  };
  [[nodiscard]] bool is_active(const Laser& laser) const;
  [[nodiscard]] bool has_scan_from(std::size_t laser) const;
  [[nodiscard]] bool has_room_for(const ScanRecord& scan) const;
  [[nodiscard]] bool is_complete() const;
  Laser& find_laser(std::size_t number);
  void finish();
  void choose_first();

  Observation scans_;  ///< that are being collected
  std::deque<Observation> ready_;
  std::vector<std::pair<std::size_t, Laser>> lasers_;  ///< with their numbers
  std::optional<std::size_t> first_;                   ///< laser with the longest pause before its scans
  std::optional<double> last_stamp_s_;
  std::uint64_t count_ = 0;  ///< number of observations
};

// The scans of one or more logs in order, each with the odometry that belongs to it. A scan's own odometry counts where
// its line carries one; else it is interpolated between the odometry records around it. Later logs continue where the
// one before ended: their odometry is moved so that its first pose is the last one of the log before. Frames: robot in
// the odometry frame of the first log. One stream belongs to one thread; memory does not depend on the length of the
// logs.

/// The log as messages name it: "-" is the standard input.
std::string log_name(const std::string& path);

/// The times of the beams where they are stated; all at the scan's stamp where nothing is to be deskewed.
void state_beam_times(const ReadOptions& options, LaserScan& scan);

/// Along the circular arc from a to b; the share is that of the time between them, and `a` where the clock stood still
/// or went backward.
Pose2 interpolated(const Odometry& a, const Odometry& b, double stamp_s);

/// Gives scans without odometry the pose between the odometry records before and after them in the log. Scans before
/// the first odometry record stay without. At most kMostHeld scans wait for the next record.
class OdometryInterpolator {
 public:
  static constexpr std::size_t kMostHeld = 64;
  void take(const Odometry& odometry);
  void take(ScanRecord scan);
  /// The next scan that is complete; with `at_end` also those that wait.
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
  /// The scans of the next observation; none lies in two logs. What next() throws comes behind the scans before it.
  /// Either of the two is to be called, not both.
  std::optional<Observation> next_observation();
  /// Looks ahead for a message of a mount, up to so many scans of the first log. What is wrong with a record that it
  /// passes is thrown when next() comes to it, or by expect_readable().
  NodKind nod_kind(std::size_t scans_ahead = kScansAhead);
  void expect_readable() const {
    if (ahead_problem_) std::rethrow_exception(ahead_problem_);
  }
  static constexpr std::size_t kScansAhead = 20;
  static constexpr std::size_t kMostAhead = 10000;  ///< records
  /// The kind of the warning where a laser that nods is taken for a level one.
  static constexpr std::string_view kUnusedNods = "nodding message not used";
  /// Takes every record but the scans, in log order, those before a scan in hand among them, and tells whether it could
  /// use it; and hears of each log that follows the first, when all scans of the one before have been given.
  struct Listener {
    std::function<bool(const LogRecord&)> record;
    std::function<void()> next_log;
  };
  void set_listener(Listener listener) { listener_ = std::move(listener); }
  /// Behind the last scan that is wanted: the listener takes one more record of the log in hand. False at its end.
  bool feed_listener();
  /// Share of the wanted scans or of the input, whichever is further; negative when unknown.
  [[nodiscard]] double progress() const;
  /// From now on, before the first scan is taken: odometry is stamped so much later than the scans that it belongs to.
  void set_odometry_delay(double delay_s) { shift_.emplace(delay_s); }
  /// Sets the times of beams that these options state.
  void set_beam_times(const ReadOptions& options) {
    options_.first_beam_after_s = options.first_beam_after_s;
    options_.beam_period_s = options.beam_period_s;
  }
  /// Scans that were read so far, those that were left out at the start among them.
  [[nodiscard]] std::uint64_t scans_read() const { return read_; }
  /// Warnings of all logs so far, by kind.
  [[nodiscard]] std::vector<LogReader::Warning> warnings() const;
  /// Questions about the scans that were given.
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
  std::exception_ptr open_problem_;    ///< problem with the log behind it
  OdometryInterpolator interpolator_;
  OdometrySpeed speed_;
  UnitCheck units_;
  std::optional<OdometryShift> shift_;
  ObservationCollector observations_;
  std::exception_ptr problem_;  ///< behind the scans of observations_
  std::deque<LogRecord> ahead_;
  std::exception_ptr ahead_problem_;  ///< behind the records of ahead_
  Listener listener_;
  std::vector<LogReader::Warning> earlier_warnings_;
  LogReader::Warning unused_{std::string(kUnusedNods), 0, ""};
  std::uint64_t read_ = 0;
  std::uint64_t given_ = 0;
  bool skipped_ = false;
  std::optional<Pose2> T_odom_base_last_;  ///< odometry of the scan before, in the frame of the first log
  std::optional<Pose2> T_first_this_;      ///< from this log's odometry frame to that of the first
};

/// Warnings of several readers as one list, counted by kind: adds the counts; of a kind that the list has, its own
/// first example stays.
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

// A signal may cut an input anywhere: in the middle of a line, or before the topics that were named.

/// The next of what `source` gives. Where `stop` says so, what a reader complains of is the end.
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
