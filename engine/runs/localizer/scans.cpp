#include "scans.hpp"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <utility>

#include "engine/core/worker_pool.hpp"
#include "engine/runs/streams/next_unless_stopped.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kBatchPerThread = 4;

struct ChosenScan {
  std::uint64_t index = 0;
  LaserScan scan;
};

/// The chosen scans one after the other.
class ScanSource {
 public:
  explicit ScanSource(const LocalizeJob& job)
      : choice_(job.choice),
        index_(job.choice.first),
        stream_({job.log}, job.read, {.skip = job.choice.first, .count = std::numeric_limits<std::uint64_t>::max()}) {}

  std::optional<ChosenScan> next() {
    if (choice_.every == 0 && index_ > choice_.first) return std::nullopt;
    for (std::optional<ScanRecord> record = stream_.next(); record; record = stream_.next()) {
      const std::uint64_t index = index_++;
      if (choice_.every == 0 || (index - choice_.first) % choice_.every == 0) {
        return ChosenScan{index, std::move(record->scan)};
      }
    }
    return std::nullopt;
  }
  ScanStream& stream() { return stream_; }

 private:
  ScanChoice choice_;
  std::uint64_t index_;
  ScanStream stream_;
};

// Scans that a signal leaves out come last: none is missing in between.
void localize_batch(const std::vector<ChosenScan>& batch, const Localizer& localizer, WorkerPool& pool,
                    const std::function<bool()>& stop, std::vector<LocalizedScan>& scans) {
  std::vector<std::optional<LocalizedScan>> found(batch.size());
  pool.run(batch.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t k = begin; k < end && !stop(); ++k) {
      found[k] = localizer.localize(batch[k].scan, batch[k].index);
    }
  });
  for (std::size_t k = 0; k < found.size() && found[k]; ++k) scans.push_back(*found[k]);
}

}  // namespace

Localized localize_scans(const LocalizeJob& job, const Localizer& localizer, const LocalizeProgress& progress,
                         const std::function<bool()>& stop) {
  Localized all;
  ScanSource source(job);
  all.nods = source.stream().nod_kind() != NodKind::kNone;
  WorkerPool pool(localizer.has_device() ? 1 : job.threads);
  const std::size_t most = kBatchPerThread * pool.threads();
  std::vector<ChosenScan> batch;
  do {
    batch.clear();
    while (batch.size() < most && !stop()) {
      std::optional<ChosenScan> scan = next_unless_stopped(source, stop);
      if (!scan) break;
      batch.push_back(std::move(*scan));
    }
    localize_batch(batch, localizer, pool, stop, all.scans);
    progress(all.scans.size(), job.choice.every == 0 ? -1.0 : source.stream().progress());
  } while (batch.size() == most && !stop());
  all.interrupted = stop();
  all.warnings = source.stream().warnings();
  if (!all.scans.empty() || all.interrupted) return all;
  const std::uint64_t read = source.stream().scans_read();
  throw InputError({job.log, 0}, read == 0 ? std::string("holds no laser scan")
                                           : fmt::format("has no scan {}: {} were read", job.choice.first, read));
}

}  // namespace gdtslam
