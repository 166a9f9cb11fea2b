#include "scan_queue.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <variant>

#include "engine/core/signals_blocked.hpp"
#include "gdtslam/core/units.hpp"

namespace gdtslam {
namespace {

constexpr std::chrono::milliseconds kQueueSlice{100};  // time between checks for a signal

bool is_scan(const LogRecord& record) { return std::holds_alternative<ScanRecord>(record); }

}  // namespace

ScanQueue::ScanQueue(std::unique_ptr<LogReader> log, std::size_t most_scans, std::function<bool()> stop,
                     std::function<void()> close)
    : log_(std::move(log)), most_scans_(most_scans), stop_(std::move(stop)), close_(std::move(close)) {
  const SignalsBlocked blocked;
  thread_ = std::thread([this] { work(); });
}

ScanQueue::~ScanQueue() {
  close_();
  thread_.join();
}

void ScanQueue::work() {
  for (bool is_end = false; !is_end;) {
    std::optional<LogRecord> record;
    std::exception_ptr problem;
    try {
      record = log_->next();
    } catch (...) {
      problem = std::current_exception();
    }
    is_end = !record;
    const std::lock_guard lock(mutex_);
    if (record) take(std::move(*record));
    warnings_ = log_->warnings();
    problem_ = problem;
    is_end_ = is_end;
    changed_.notify_one();
  }
}

void ScanQueue::take(LogRecord record) {
  if (is_scan(record)) {
    if (scans_ >= most_scans_) drop_oldest_scan();
    ++scans_;
  }
  records_.push_back(std::move(record));
}

void ScanQueue::drop_oldest_scan() {
  const auto oldest = std::find_if(records_.begin(), records_.end(), is_scan);
  const auto& scan = std::get<ScanRecord>(*oldest);
  if (dropped_++ == 0) first_dropped_s_ = scan.scan.stamp_s;
  --scans_;
  if (scan.T_odom_base) {
    *oldest = Odometry{scan.scan.stamp_s, *scan.T_odom_base};
  } else {
    records_.erase(oldest);
  }
}

std::optional<LogRecord> ScanQueue::next() {
  std::unique_lock lock(mutex_);
  while (records_.empty() && !is_end_) {
    if (stop_()) return std::nullopt;
    changed_.wait_for(lock, kQueueSlice);
  }
  if (records_.empty()) {
    if (problem_) std::rethrow_exception(problem_);
    return std::nullopt;
  }
  LogRecord record = std::move(records_.front());
  records_.pop_front();
  if (is_scan(record)) --scans_;
  return record;
}

const std::vector<LogReader::Warning>& ScanQueue::warnings() const {
  const std::lock_guard lock(mutex_);
  given_warnings_ = warnings_;
  if (dropped_ > 0) {
    given_warnings_.push_back(
        {"scan dropped, the queue was full", dropped_, "at " + format_quantity(first_dropped_s_, Unit::kSecond)});
  }
  return given_warnings_;
}

}  // namespace gdtslam
