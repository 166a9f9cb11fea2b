#include "simulated_files.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <variant>

#include "engine/io/logs/carmen.hpp"
#include "engine/io/logs/carmen_writer.hpp"

namespace gdtslam {
namespace {

constexpr int kElevationDecimals = 12;

// Little-endian, as the header says, on every host.
template <class Word>
void append_word(std::string& row, Word word) {
  for (std::size_t byte = 0; byte < sizeof(Word); ++byte) {
    row += static_cast<char>((word >> (8 * byte)) & 0xffU);
  }
}

void append_double(std::string& row, double value) { append_word(row, std::bit_cast<std::uint64_t>(value)); }

std::string ply_header(std::uint64_t rows) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment true hits of a simulated scan\nelement vertex " +
                       std::to_string(rows) + "\n";
  for (const char* name : {"x", "y", "z", "elevation", "time", "range"}) {
    header += std::string("property double ") + name + "\n";
  }
  for (const char* name : {"scan", "beam", "triangle"}) {
    header += std::string("property uint ") + name + "\n";
  }
  return header + "end_header\n";
}

}  // namespace

ElevationRows::ElevationRows(AtomicFile& file) : file_(file) {
  file_.write(std::string_view("scan,stamp_s,crank_turns,elevation_rad\n"));
}

void ElevationRows::add(const sim::SimulatedScan& scan) {
  file_.write(std::to_string(scans_++) + "," + fixed_text(scan.record.scan.stamp_s, 6) + "," +
              fixed_text(scan.crank_turns, kElevationDecimals) + "," +
              fixed_text(scan.elevation_rad, kElevationDecimals) + "\n");
}

void HitCloud::add(const sim::SimulatedScan& scan, double max_range_m) {
  const LaserScan& measured = scan.record.scan;
  row_.clear();
  for (std::size_t beam = 0; beam < scan.beams.size(); ++beam) {
    if (static_cast<double>(measured.ranges_m[beam]) >= limit_of_floats_m(max_range_m)) {
      continue;
    }
    const sim::BeamTruth& truth = scan.beams[beam];
    const double time_s = measured.stamp_s + truth.offset_s;
    for (const double value :
         {truth.hit_m.x(), truth.hit_m.y(), truth.hit_m.z(),
          scan.course != nullptr ? scan.course->elevation_rad(time_s) : 0.0, time_s, truth.range_m}) {
      append_double(row_, value);
    }
    append_word(row_, static_cast<std::uint32_t>(scans_));
    append_word(row_, static_cast<std::uint32_t>(beam));
    append_word(row_, truth.triangle);
    ++hits_;
  }
  ++scans_;
  rows_.write(bytes_, std::as_bytes(std::span(row_)));
  bytes_ += row_.size();
}

void HitCloud::finish() {
  file_.write(ply_header(hits_));
  std::array<char, 65536> block{};
  for (std::uint64_t place = 0; place < bytes_; place += block.size()) {
    const std::span<char> part = std::span(block).first(std::min<std::uint64_t>(block.size(), bytes_ - place));
    rows_.read(place, std::as_writable_bytes(part));
    file_.write(std::string_view(part.data(), part.size()));
  }
}

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
