#include "simulated_log.hpp"

#include <variant>

#include "engine/io/logs/carmen.hpp"

namespace gdtslam {

SimulatedLog::SimulatedLog(const std::string& path, const UnsaidOfScans& unsaid, AtomicFileSet& files)
    : unsaid_(unsaid) {
  const LogFormat format = log_format_by_ending(path).value_or(LogFormat::kCarmen);
  if (format == LogFormat::kCarmen) {
    text_ = std::make_unique<TextSink>(files.add(path));
  } else {
    records_ = make_log_writer(format, path, {}, files);
  }
}

void SimulatedLog::write(std::string_view lines) {
  if (text_) {
    const bool is_scan = lines.starts_with("FLASER") || lines.starts_with("ROBOTLASER1");
    untimed_scans_ += is_scan && unsaid_.beam_period_s != 0.0 ? 1U : 0U;
    text_->write(lines);
    return;
  }
  while (!lines.empty()) {
    const std::size_t end = lines.find('\n');
    CarmenLine line = parse_carmen_line(lines.substr(0, end), {});
    if (auto* const scan = std::get_if<ScanRecord>(&*line.record)) {
      scan->scan.max_range_m = unsaid_.max_range_m;
      scan->scan.beam_period_s = unsaid_.beam_period_s;
      scan->scan.T_base_laser = mount_.of(scan->scan.T_base_laser, line.pose_decimals);
    }
    records_->write(*line.record);
    lines.remove_prefix(end + 1);
  }
}

void SimulatedLog::finish() {
  if (text_) {
    text_->finish();
  } else {
    records_->finish();
  }
}

std::vector<LogReader::Warning> SimulatedLog::left_out() const {
  if (!text_) return records_->left_out();
  if (untimed_scans_ == 0) return {};
  return {{"time of each beam", untimed_scans_, "every scan"}};
}

}  // namespace gdtslam
