// Scans of logs with their odometry.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "convert.hpp"
#include "engine/core/files/interruption.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "guard.hpp"
#include "options.hpp"

namespace gdtslam::c {

/// The caller of a reader, asked whether a wait for a pipe continues after a signal.
class ReaderCaller {
 public:
  explicit ReaderCaller(const gdtslam_reader_request& request)
      : progress_(request.progress), user_data_(request.user_data) {}

  /// Returns the result of the work, which may wait. If the caller ends the wait, or throws, the log seems to end
  /// there, perhaps in the middle of a scan. Then nothing more is read: this and later calls throw Error(kInterrupted).
  template <class Work>
  auto unless_interrupted(std::uint64_t scans, const Work& work) {
    const AskedAfterSignals asked([this, scans] { return wants_end(scans); });
    try {
      refuse_where_interrupted();
      auto result = work();
      refuse_where_interrupted();
      return result;
    } catch (const Error& problem) {  // perhaps because the log ends too early
      if (problem.code() != ExitCode::kInterrupted) refuse_where_interrupted();
      throw;
    }
  }

 private:
  bool wants_end(std::uint64_t scans) {
    if (progress_ == nullptr) return false;
    is_interrupted_ = true;
    is_interrupted_ = progress_(user_data_, "scans", scans, -1.0) != 0;
    return is_interrupted_;
  }
  void refuse_where_interrupted() const {
    if (!is_interrupted_) return;
    throw Error(ExitCode::kInterrupted, "interrupted while the log gave nothing; open it again");
  }

  gdtslam_progress progress_;
  void* user_data_;
  bool is_interrupted_ = false;
};

}  // namespace gdtslam::c

struct gdtslam_reader {
  gdtslam_reader(const gdtslam_reader_request& request, std::vector<std::string> logs,
                 const gdtslam::ReadOptions& options)
      : caller(request),
        scans(caller.unless_interrupted(0, [&] { return gdtslam::ScanStream(std::move(logs), options, {}); })) {}

  gdtslam::c::ReaderCaller caller;
  gdtslam::ScanStream scans;
  gdtslam::ScanRecord last;
  std::vector<gdtslam::LogReader::Warning> warnings;  ///< the warnings last given to the caller
};

namespace {

using namespace gdtslam;
using namespace gdtslam::c;

void open_reader(const gdtslam_reader_request& given, gdtslam_reader** reader, const std::string& call) {
  require(given.logs, (call + ": logs").c_str());
  if (given.log_count == 0) throw UsageError(call + ": no log");
  if ((given.flags & ~static_cast<uint32_t>(GDTSLAM_LENIENT)) != 0 || given.reserved != 0) {
    throw UsageError(call + ": a flag that means nothing here");
  }
  std::vector<std::string> logs;
  for (std::size_t k = 0; k < given.log_count; ++k) {
    require(given.logs[k], (call + ": a log").c_str());
    logs.emplace_back(given.logs[k]);
  }
  const ReadOptions options = read_options_of(read_settings(given.options).log, (given.flags & GDTSLAM_LENIENT) != 0);
  *reader = std::make_unique<gdtslam_reader>(given, std::move(logs), options).release();
}

}  // namespace

gdtslam_status gdtslam_reader_new(const gdtslam_reader_request* request, gdtslam_reader** reader,
                                  gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(reader, "gdtslam_reader_new: reader");
    constexpr std::size_t kLeast = GDTSLAM_SIZE_WITH(gdtslam_reader_request, log_count);
    open_reader(read_struct(request, kLeast, "gdtslam_reader_new: request"), reader, "gdtslam_reader_new");
  });
}

gdtslam_status gdtslam_reader_open(const char* const* logs, size_t log_count, const gdtslam_options* options,
                                   uint32_t flags, gdtslam_reader** reader, gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(reader, "gdtslam_reader_open: reader");
    gdtslam_reader_request request{};
    request.logs = logs;
    request.log_count = log_count;
    request.options = options;
    request.flags = flags;
    open_reader(request, reader, "gdtslam_reader_open");
  });
}

void gdtslam_reader_free(gdtslam_reader* reader) { delete reader; }

gdtslam_status gdtslam_reader_next(gdtslam_reader* reader, gdtslam_scan* scan, int32_t* has_scan,
                                   gdtslam_error* error) {
  return guarded(error, [&] {
    require(has_scan, "gdtslam_reader_next: has_scan");
    *has_scan = 0;
    require(reader, "gdtslam_reader_next: reader");
    require_writable(scan, "gdtslam_reader_next: scan");  // checked before a scan is read that would not fit
    std::optional<ScanRecord> record =
        reader->caller.unless_interrupted(reader->scans.scans_read(), [reader] { return reader->scans.next(); });
    if (!record) return;
    reader->last = std::move(*record);
    write_struct(to_c(reader->last), scan, "gdtslam_reader_next: scan");
    *has_scan = 1;
  });
}

double gdtslam_reader_progress(const gdtslam_reader* reader) {
  return reader == nullptr ? -1.0 : reader->scans.progress();
}

gdtslam_status gdtslam_reader_warning(gdtslam_reader* reader, size_t index, gdtslam_log_warning* warning,
                                      int32_t* has_warning, gdtslam_error* error) {
  return guarded(error, [&] {
    require(has_warning, "gdtslam_reader_warning: has_warning");
    *has_warning = 0;
    require(reader, "gdtslam_reader_warning: reader");
    reader->warnings = reader->scans.warnings();
    if (index >= reader->warnings.size()) return;
    const LogReader::Warning& w = reader->warnings[index];
    write_struct<gdtslam_log_warning>({.size = 0, .kind = w.kind.c_str(), .first = w.first.c_str(), .count = w.count},
                                      warning, "gdtslam_reader_warning: warning");
    *has_warning = 1;
  });
}
