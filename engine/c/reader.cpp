// Scans of logs with the odometry that belongs to them.
#include <memory>
#include <string>
#include <vector>

#include "convert.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "guard.hpp"
#include "options.hpp"
#include "structs.hpp"

struct gdtslam_reader {
  gdtslam_reader(std::vector<std::string> logs, const gdtslam::ReadOptions& options)
      : scans(std::move(logs), options, {}) {}

  gdtslam::ScanStream scans;
  gdtslam::ScanRecord last;
  std::vector<gdtslam::LogReader::Warning> warnings;  ///< those that were last given out
};

using namespace gdtslam::c;

gdtslam_status gdtslam_reader_open(const char* const* logs, size_t log_count, const gdtslam_options* options,
                                   uint32_t flags, gdtslam_reader** reader, gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(reader, "gdtslam_reader_open: reader");
    require(logs, "gdtslam_reader_open: logs");
    if (log_count == 0) throw gdtslam::UsageError("gdtslam_reader_open: no log");
    if ((flags & ~static_cast<uint32_t>(GDTSLAM_LENIENT)) != 0) {
      throw gdtslam::UsageError("gdtslam_reader_open: a flag that means nothing here");
    }
    std::vector<std::string> paths;
    for (size_t k = 0; k < log_count; ++k) {
      require(logs[k], "gdtslam_reader_open: a log");
      paths.emplace_back(logs[k]);
    }
    const gdtslam::ReadOptions read =
        gdtslam::read_options_of(settings_of(options).log, (flags & GDTSLAM_LENIENT) != 0);
    *reader = std::make_unique<gdtslam_reader>(std::move(paths), read).release();
  });
}

void gdtslam_reader_free(gdtslam_reader* reader) { delete reader; }

gdtslam_status gdtslam_reader_next(gdtslam_reader* reader, gdtslam_scan* scan, int32_t* has_scan,
                                   gdtslam_error* error) {
  return guarded(error, [&] {
    require(has_scan, "gdtslam_reader_next: has_scan");
    *has_scan = 0;
    require(reader, "gdtslam_reader_next: reader");
    require(scan, "gdtslam_reader_next: scan");
    std::optional<gdtslam::ScanRecord> record = reader->scans.next();
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
    const gdtslam::LogReader::Warning& w = reader->warnings[index];
    write_struct<gdtslam_log_warning>({.size = 0, .kind = w.kind.c_str(), .first = w.first.c_str(), .count = w.count},
                                      warning, "gdtslam_reader_warning: warning");
    *has_warning = 1;
  });
}
