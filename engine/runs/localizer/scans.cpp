#include "scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <utility>

#include "engine/core/signals_blocked.hpp"
#include "engine/runs/streams/next_unless_stopped.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

/// A scan that was chosen.
struct ChosenScan {
  std::uint64_t number = 0;  ///< among those chosen, in the log's order
  std::uint64_t index = 0;
  LaserScan scan;
  std::optional<Pose2> T_map_base_reference;
};

ScanStream stream_of(const LocalizeJob& job, std::uint64_t skip) {
  return {{job.log}, job.read, {.skip = skip, .count = std::numeric_limits<std::uint64_t>::max()}};
}

/// Draws without replacement; indices of scans, ascending.
std::vector<std::uint64_t> drawn(std::vector<std::uint64_t> from, std::uint64_t count, std::uint64_t seed) {
  Random random(seed);
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(count, from.size()));
  for (std::size_t k = 0; k < wanted; ++k) std::swap(from[k], from[k + random.below(from.size() - k)]);
  from.resize(wanted);
  std::sort(from.begin(), from.end());
  return from;
}

/// The chosen scans one after the other; counts what it passes.
class ScanSource {
 public:
  ScanSource(const LocalizeJob& job, Localized& counts, const std::function<bool()>& stop)
      : job_(job), counts_(counts), index_(job.choice.random > 0 ? 0 : job.choice.first) {
    if (job.choice.random > 0) choose(stop);
    stream_.emplace(stream_of(job, index_));
    counts.nods = stream_->nod_kind() != NodKind::kNone;
  }

  std::optional<ChosenScan> next();
  [[nodiscard]] double progress(std::uint64_t done) const {
    if (job_.choice.random == 0) return job_.choice.every == 0 ? -1.0 : stream_->progress();
    return static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(drawn_.size(), 1));
  }
  [[nodiscard]] std::uint64_t scans_read() const { return stream_->scans_read(); }
  /// Of the pass that went furthest.
  [[nodiscard]] std::vector<LogReader::Warning> warnings() const {
    return job_.choice.random > 0 ? warnings_ : stream_->warnings();
  }

 private:
  void choose(const std::function<bool()>& stop);
  [[nodiscard]] bool is_wanted(double stamp_s);
  [[nodiscard]] bool is_chosen(std::uint64_t index, double stamp_s);
  [[nodiscard]] std::optional<Pose2> reference_of(double stamp_s) const {
    return job_.reference ? job_.reference->find(stamp_s) : std::nullopt;
  }

  const LocalizeJob& job_;
  Localized& counts_;
  std::uint64_t index_;
  std::optional<ScanStream> stream_;
  std::vector<std::uint64_t> drawn_;
  std::vector<LogReader::Warning> warnings_;
  std::uint64_t given_ = 0;
};

// Counts a scan that could be chosen, or why not.
bool ScanSource::is_wanted(double stamp_s) {
  if (job_.merged && job_.merged->are_near(stamp_s)) {
    ++counts_.left_out;
    return false;
  }
  if (job_.choice.random > 0 && job_.reference && !reference_of(stamp_s)) {
    ++counts_.without_reference;
    return false;
  }
  ++counts_.candidates;
  return true;
}

// A first pass over the log tells which scans there are.
void ScanSource::choose(const std::function<bool()>& stop) {
  if (job_.log == "-") {
    throw UsageError("--random reads the log twice: give a file, not standard input");
  }
  ScanStream scans = stream_of(job_, 0);
  std::vector<std::uint64_t> candidates;
  std::uint64_t index = 0;
  for (std::optional<ScanRecord> record = scans.next(); record && !stop(); record = scans.next(), ++index) {
    if (is_wanted(record->scan.stamp_s)) candidates.push_back(index);
  }
  warnings_ = scans.warnings();
  drawn_ = drawn(std::move(candidates), job_.choice.random, job_.choice.seed);
}

// What was drawn has been asked for before.
bool ScanSource::is_chosen(std::uint64_t index, double stamp_s) {
  const ScanChoice& choice = job_.choice;
  if (choice.random > 0) return index == drawn_[given_];
  return (choice.every == 0 || (index - choice.first) % choice.every == 0) && is_wanted(stamp_s);
}

std::optional<ChosenScan> ScanSource::next() {
  const ScanChoice& choice = job_.choice;
  if (choice.random > 0 ? given_ == drawn_.size() : choice.every == 0 && given_ == 1) return std::nullopt;
  for (std::optional<ScanRecord> record = stream_->next(); record; record = stream_->next()) {
    const std::uint64_t index = index_++;
    if (!is_chosen(index, record->scan.stamp_s)) continue;
    const double stamp_s = record->scan.stamp_s;
    return ChosenScan{given_++, index, std::move(record->scan), reference_of(stamp_s)};
  }
  return std::nullopt;
}

/// Threads that localise what this one reads. A signal comes to the reading thread, which may wait for input.
class LocalizerThreads {
 public:
  /// Without threads each scan is localised when it is taken.
  LocalizerThreads(const Localizer& localizer, unsigned threads) : localizer_(localizer), most_waiting_(2U * threads) {
    const SignalsBlocked blocked;
    threads_.reserve(threads);
    try {
      while (threads_.size() < threads) threads_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {  // those that are there do it
      return;
    } catch (const std::bad_alloc&) {
      return;
    }
  }
  LocalizerThreads(const LocalizerThreads&) = delete;
  LocalizerThreads& operator=(const LocalizerThreads&) = delete;
  ~LocalizerThreads() { close(true); }

  /// Waits while enough scans wait; rethrows what a thread met.
  std::uint64_t take(ChosenScan scan) {
    if (threads_.empty()) {
      found_.emplace(scan.number, localizer_.localize(scan.scan, scan.index, scan.T_map_base_reference));
      return found_.size();
    }
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return problem_ || waiting_.size() < most_waiting_; });
    if (problem_) std::rethrow_exception(problem_);
    waiting_.push_back(std::move(scan));
    changed_.notify_all();
    return found_.size();
  }
  /// Whether none are waiting or in hand; waits for a change, some tenths of a second at most.
  bool is_idle(std::uint64_t& done) {
    std::unique_lock lock(mutex_);
    const auto idle = [this] { return problem_ || (waiting_.empty() && in_hand_ == 0); };
    const bool is_done = changed_.wait_for(lock, std::chrono::milliseconds(100), idle);
    done = found_.size();
    if (problem_) std::rethrow_exception(problem_);
    return is_done;
  }
  /// What is in hand is finished; `at_once`: what waits is not begun.
  std::vector<LocalizedScan> finish(bool at_once) {
    close(at_once);
    if (problem_) std::rethrow_exception(problem_);
    std::vector<LocalizedScan> scans;
    for (const auto& [number, scan] : found_) scans.push_back(scan);
    return scans;
  }

 private:
  void close(bool at_once) {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
      if (at_once) waiting_.clear();
      changed_.notify_all();
    }
    threads_.clear();
  }
  void work();

  const Localizer& localizer_;
  std::size_t most_waiting_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<ChosenScan> waiting_;
  std::map<std::uint64_t, LocalizedScan> found_;  // by number
  unsigned in_hand_ = 0;
  bool closed_ = false;
  std::exception_ptr problem_;
  std::vector<std::jthread> threads_;
};

void LocalizerThreads::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
    if (waiting_.empty() || problem_) return;
    const ChosenScan chosen = std::move(waiting_.front());
    waiting_.pop_front();
    ++in_hand_;
    lock.unlock();
    std::optional<LocalizedScan> found;
    std::exception_ptr problem;
    try {
      found = localizer_.localize(chosen.scan, chosen.index, chosen.T_map_base_reference);
    } catch (...) {
      problem = std::current_exception();
    }
    lock.lock();
    --in_hand_;
    if (found) found_.emplace(chosen.number, *found);
    if (problem && !problem_) problem_ = problem;
    changed_.notify_all();
  }
}

[[noreturn]] void complain(const LocalizeJob& job, const Localized& all, std::uint64_t read) {
  const ScanChoice& choice = job.choice;
  if (all.left_out + all.without_reference == 0) {
    throw InputError({job.log, 0}, choice.random > 0 || read == 0
                                       ? std::string("holds no laser scan")
                                       : fmt::format("has no scan {}: {} were read", choice.first, read));
  }
  std::string reasons;
  if (all.left_out > 0) {
    reasons = fmt::format("; left out: {} {}", all.left_out, near_text(*job.merged));
  }
  if (all.without_reference > 0) {
    reasons += fmt::format("; {} have no pose in {}; do both belong to the same log?", all.without_reference,
                           job.reference->file());
  }
  throw InputError({job.log, 0}, "has no scan left to localise" + reasons);
}

}  // namespace

Localized localize_scans(const LocalizeJob& job, const Localizer& localizer, const LocalizeProgress& progress,
                         const std::function<bool()>& stop) {
  Localized all;
  ScanSource source(job, all, stop);
  LocalizerThreads threads(localizer, localizer.has_device() ? 0 : job.threads);
  std::uint64_t chosen = 0;
  while (!stop()) {
    std::optional<ChosenScan> scan = next_unless_stopped(source, stop);
    if (!scan) break;
    const std::uint64_t done = threads.take(std::move(*scan));
    ++chosen;
    progress(done, source.progress(done));
  }
  std::uint64_t done = 0;
  while (!stop() && !threads.is_idle(done)) progress(done, source.progress(done));
  all.interrupted = stop();
  all.scans = threads.finish(all.interrupted);
  all.warnings = source.warnings();
  if (chosen == 0 && !all.interrupted) complain(job, all, source.scans_read());
  return all;
}

}  // namespace gdtslam
