// Scans of logs with a nodding laser, each with the positions of the crank during the scan. A scan waits until the
// crank's messages cover it, or until it is clear that none will. One stream belongs to one thread; memory: the waiting
// scans.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "gdtslam/calib/nod_track.hpp"
#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "scan_stream.hpp"

namespace gdtslam {

class NoddingStream {
 public:
  /// `kind`: the messages in the logs, ENCODER or TILT. The stream of scans must outlive this.
  NoddingStream(ScanStream& scans, NodKind kind, const calib::SweepModel& model, const calib::NodTrackLimits& limits);
  NoddingStream(const NoddingStream&) = delete;
  NoddingStream& operator=(const NoddingStream&) = delete;
  ~NoddingStream();

  /// The next scan in log order; its knots are empty if the messages do not cover it. Throws as ScanStream does.
  std::optional<NoddingScan> next();
  /// Faults of the messages so far, by kind, and uncovered scans.
  [[nodiscard]] std::vector<LogReader::Warning> warnings() const;

  static constexpr std::size_t kMostWaiting = 1000;

 private:
  struct Waiting {
    ScanRecord record;
    double from_s = 0.0;  ///< after the stamp
    double to_s = 0.0;
    bool is_set_back = false;  ///< stamped before the previous scan: the messages' clock may follow
  };
  bool take(const LogRecord& record);
  void take_scan(ScanRecord record);
  void expect_set_back(double stamp_s);
  void begin_log();
  [[nodiscard]] calib::NodTrack new_track() const;
  [[nodiscard]] bool can_resolve(const Waiting& scan) const;
  void resolve_first();

  ScanStream& scans_;
  NodKind kind_;
  calib::SweepModel model_;
  calib::NodTrackLimits limits_;
  calib::NodTrack track_;
  std::vector<LogReader::Warning> earlier_;  ///< warnings of earlier logs
  std::deque<Waiting> waiting_;
  std::deque<NoddingScan> ready_;
  std::uint64_t given_ = 0;
  double last_scan_s_ = -std::numeric_limits<double>::infinity();
  LogReader::Warning uncovered_{"scans without the crank's position", 0, ""};
};

}  // namespace gdtslam
