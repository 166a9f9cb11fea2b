#include "scan_ahead.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "engine/core/side_thread.hpp"
#include "engine/core/signals_blocked.hpp"

namespace gdtslam {

bool are_plain_files(const std::vector<std::string>& logs) {
  return std::all_of(logs.begin(), logs.end(), [](const std::string& log) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(log, ignored) || std::filesystem::is_directory(log, ignored);
  });
}

ScanAhead::ScanAhead(ScanStream& scans, bool has_thread) : scans_(scans), has_thread_(has_thread) {
  if (!has_thread_) return;
  progress_ = scans_.progress();
  const SignalsBlocked blocked;
  try {
    thread_ = std::thread([this] { work(); });
  } catch (const std::system_error&) {  // then the caller reads
    has_thread_ = false;
  }
}

ScanAhead::Read ScanAhead::read_one() {
  Read read;
  try {
    read.observation = scans_.next_observation();
  } catch (...) {
    read.problem = std::current_exception();
  }
  read.progress = scans_.progress();
  return read;
}

void ScanAhead::work() {
  bool is_end = false;
  while (!is_end) {
    Read read = read_one();
    is_end = !read.observation;
    std::unique_lock lock(mutex_);
    read_.push_back(std::move(read));
    if (read_.size() == 1 || is_end) read_changed_.notify_one();
    if (read_.size() >= kMostAhead) room_.wait(lock, [this] { return is_stopped_ || read_.size() < kMostAhead; });
    if (is_stopped_) break;
  }
  const std::lock_guard lock(mutex_);
  cpu_s_ = own_cpu_s();
}

// Takes all that was read at once, so that the two threads seldom wait for each other. After the end it returns none.
std::optional<Observation> ScanAhead::next() {
  if (!has_thread_) return scans_.next_observation();
  if (taken_.empty()) {
    std::unique_lock lock(mutex_);
    read_changed_.wait(lock, [this] { return !read_.empty(); });
    taken_.swap(read_);
    room_.notify_one();
  }
  Read& first = taken_.front();
  progress_ = first.progress;
  if (first.problem) std::rethrow_exception(first.problem);
  if (!first.observation) return std::nullopt;
  std::optional<Observation> observation = std::move(first.observation);
  taken_.pop_front();
  return observation;
}

void ScanAhead::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  room_.notify_one();
  if (thread_.joinable()) thread_.join();
}

}  // namespace gdtslam
