#include "nodding_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <variant>

#include "scan_stream.hpp"

namespace gdtslam {
namespace {

constexpr double kLatest_s = 1.0;   // messages this much later in the log's time than a scan are too late
constexpr double kMemory_s = 10.0;  // memory of the track, for stamps that step back
constexpr int kMostBehind = 1000;   // records read after the last scan for messages that cover it

}  // namespace

NoddingStream::NoddingStream(ScanStream& scans, NodKind kind, const calib::SweepModel& model,
                             const calib::NodTrackLimits& limits)
    : scans_(scans), kind_(kind), model_(model), limits_(limits), track_(new_track()) {
  scans_.set_listener({[this](const LogRecord& record) { return take(record); }, [this] { begin_log(); }});
}

NoddingStream::~NoddingStream() { scans_.set_listener({}); }

calib::NodTrack NoddingStream::new_track() const {
  return kind_ == NodKind::kTilt ? calib::NodTrack(limits_) : calib::NodTrack(model_.encoder, limits_);
}

bool NoddingStream::take(const LogRecord& record) {
  if (const auto* encoder = std::get_if<Encoder>(&record); encoder && kind_ == NodKind::kEncoder) {
    expect_set_back(encoder->stamp_s);
    track_.take(*encoder);
    return true;
  }
  if (const auto* tilt = std::get_if<Tilt>(&record); tilt && kind_ == NodKind::kTilt) {
    expect_set_back(tilt->stamp_s);
    track_.take(*tilt);
    return true;
  }
  return false;
}

// After a clock was set back, no later message covers the scans from before.
void NoddingStream::expect_set_back(double stamp_s) {
  if (!track_.begins_again_at(stamp_s)) return;
  while (!waiting_.empty() && !waiting_.front().is_set_back) resolve_first();
  for (Waiting& scan : waiting_) scan.is_set_back = false;
}

// Another log has its own clock, so no further message covers the scans of the previous log.
void NoddingStream::begin_log() {
  while (!waiting_.empty()) resolve_first();
  merge_warnings(earlier_, track_.faults().as_warnings());
  track_ = new_track();
  last_scan_s_ = -std::numeric_limits<double>::infinity();
}

bool NoddingStream::can_resolve(const Waiting& scan) const {
  const double end_s = scan.record.scan.stamp_s + scan.to_s;
  const std::optional<double> known_s = track_.known_until_s();
  return (known_s && *known_s >= end_s && !scan.is_set_back) ||
         waiting_.back().record.scan.stamp_s > end_s + kLatest_s || waiting_.size() > kMostWaiting;
}

void NoddingStream::resolve_first() {
  Waiting scan = std::move(waiting_.front());
  waiting_.pop_front();
  const double stamp_s = scan.record.scan.stamp_s;
  NoddingScan found{std::move(scan.record), track_.knots(stamp_s, stamp_s + scan.from_s, stamp_s + scan.to_s)};
  if (found.knots.empty()) {
    if (uncovered_.count++ == 0) uncovered_.first = fmt::format("scan {} at {:.6f} s", given_ + ready_.size(), stamp_s);
  }
  // One stamp far ahead must not discard knots that other scans need.
  double oldest_s = std::min(stamp_s, track_.known_until_s().value_or(stamp_s));
  for (const Waiting& other : waiting_) oldest_s = std::min(oldest_s, other.record.scan.stamp_s);
  track_.forget_before(oldest_s - kMemory_s);
  ready_.push_back(std::move(found));
}

void NoddingStream::take_scan(ScanRecord record) {
  order_beams_by_time(record.scan);
  const BeamTiming timing = calib::beam_timing(model_, record.scan);
  const std::size_t last = record.scan.ranges_m.empty() ? 0 : record.scan.ranges_m.size() - 1;
  const double stamp_s = record.scan.stamp_s;
  waiting_.push_back({std::move(record), timing.first_s, timing.of_beam_s(last), stamp_s < last_scan_s_});
  last_scan_s_ = stamp_s;
}

std::optional<NoddingScan> NoddingStream::next() {
  while (ready_.empty()) {
    std::optional<ScanRecord> record = scans_.next();
    if (record) {
      take_scan(std::move(*record));
      while (!waiting_.empty() && can_resolve(waiting_.front())) resolve_first();
      continue;
    }
    if (waiting_.empty()) return std::nullopt;
    // The log continues after --first, with messages that cover the last scans.
    for (int k = 0; k < kMostBehind && !can_resolve(waiting_.front()) && scans_.feed_listener(); ++k) {
    }
    resolve_first();
  }
  NoddingScan scan = std::move(ready_.front());
  ready_.pop_front();
  ++given_;
  return scan;
}

std::vector<LogReader::Warning> NoddingStream::warnings() const {
  std::vector<LogReader::Warning> list = earlier_;
  merge_warnings(list, track_.faults().as_warnings());
  if (uncovered_.count > 0) list.push_back(uncovered_);
  return list;
}

}  // namespace gdtslam
