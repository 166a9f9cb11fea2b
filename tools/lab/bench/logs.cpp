// How fast logs are read, of every format: a drive is written by our own writers and read again, beside the file's
// bytes alone and beside a checksum of them, or their decompression, alone.
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/elementary.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/recordings/containers/chunk.hpp"
#include "engine/io/writers/chunk_packer.hpp"
#include "engine/io/writers/log_writer.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/io/log.hpp"
#include "rows.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

constexpr double kMega = 1e6;
constexpr std::size_t kDriveBeams = 720;
constexpr std::size_t kPieceBytes = std::size_t{1} << 20U;
constexpr std::size_t kMostFloorBytes = std::size_t{64} << 20U;  // of a file, that are kept for what goes on in memory

/// What the same bytes cost by themselves.
enum class Floor : std::uint8_t { kChecksum, kLz4, kZstd, kGzip };

struct LogKind {
  std::string_view name;
  std::string_view packing;
  std::string_view file;
  LogFormat format;
  std::optional<ChunkPacking> chunks;
  Floor floor;
  std::string_view plain;  ///< the file of the same bytes unpacked; none: itself
};
constexpr std::array<LogKind, 9> kLogKinds{{
    {"ROS 1 bag", "none", "none.bag", LogFormat::kBag, ChunkPacking::kNone, Floor::kChecksum, ""},
    {"ROS 1 bag", "lz4", "lz4.bag", LogFormat::kBag, ChunkPacking::kLz4, Floor::kLz4, "none.bag"},
    {"MCAP", "none", "none.mcap", LogFormat::kMcap, ChunkPacking::kNone, Floor::kChecksum, ""},
    {"MCAP", "zstd", "zstd.mcap", LogFormat::kMcap, ChunkPacking::kZstd, Floor::kZstd, "none.mcap"},
    {"ROS 2 database", "none", "drive.db3", LogFormat::kDb3, std::nullopt, Floor::kChecksum, ""},
    {"CSV", "none", "drive.csv", LogFormat::kCsv, std::nullopt, Floor::kChecksum, ""},
    {"JSON lines", "none", "drive.jsonl", LogFormat::kJsonLines, std::nullopt, Floor::kChecksum, ""},
    {"CARMEN", "none", "drive.log", LogFormat::kCarmen, std::nullopt, Floor::kChecksum, ""},
    {"CARMEN", "gzip", "drive.log.gz", LogFormat::kCarmen, std::nullopt, Floor::kGzip, "drive.log"},
}};

/// A robot on a circle in a room of 24 x 12 m, as a laser of 0.5 deg over the whole turn sees it: ranges by the walls'
/// equations, 1 cm of noise, whole millimetres.
class BenchDrive {
 public:
  static LogRecord odometry(std::uint64_t index) {
    return Odometry{.stamp_s = stamp_s(index), .T_odom_base = pose(index)};
  }
  LogRecord scan(std::uint64_t index) {
    const Pose2 T_odom_base = pose(index);
    ScanRecord record{.scan = {.stamp_s = stamp_s(index),
                               .first_bearing_rad = -kPi,
                               .bearing_step_rad = kTwoPi / static_cast<double>(kDriveBeams),
                               .max_range_m = 30.0,
                               .ranges_m = {},
                               .T_base_laser = {}},
                      .T_odom_base = T_odom_base};
    record.scan.ranges_m.reserve(kDriveBeams);
    for (std::size_t k = 0; k < kDriveBeams; ++k) {
      const double bearing_rad = record.scan.first_bearing_rad + static_cast<double>(k) * record.scan.bearing_step_rad;
      const double range_m = wall_m(T_odom_base, T_odom_base.theta_rad + bearing_rad) + random_.normal(0.0, 0.01);
      record.scan.ranges_m.push_back(static_cast<float>(std::round(1000.0 * range_m) / 1000.0));
    }
    return record;
  }

 private:
  static constexpr double kDriveScan_s = 0.1;
  static double stamp_s(std::uint64_t index) { return 1.6e9 + kDriveScan_s * static_cast<double>(index); }
  static Pose2 pose(std::uint64_t index) {
    const double turn_rad = wrap_angle(0.02 * static_cast<double>(index));
    const SinCos<double> turn = sin_cos(turn_rad);
    return {4.0 * turn.cos, 4.0 * turn.sin, wrap_angle(turn_rad + 0.5 * kPi)};
  }
  static double wall_m(const Pose2& T, double direction_rad) {
    const auto along = [](double from, double slope, double half) {
      return slope == 0.0 ? 1e9 : ((slope > 0.0 ? half : -half) - from) / slope;
    };
    const SinCos<double> direction = sin_cos(direction_rad);
    return std::min(along(T.x_m, direction.cos, 12.0), along(T.y_m, direction.sin, 6.0));
  }

  Random random_{1};
};

struct LogBenchRow {
  const LogKind* kind = nullptr;
  std::uint64_t file_bytes = 0;
  std::uint64_t bytes = 0;  ///< unpacked
  Timing read{};
  Timing plain{};
  double floor_s = 0.0;  ///< CPU time for all bytes
  std::optional<std::uint64_t> peak_bytes{};
};

/// The most memory that this process had since begin(); nothing where the system does not tell.
class PeakMemory {
 public:
  PeakMemory() {
    std::ofstream file("/proc/self/clear_refs");
    file << "5";
    file.flush();
    is_known_ = file.good();
  }
  [[nodiscard]] std::optional<std::uint64_t> bytes() const {
    std::ifstream file("/proc/self/status");
    for (std::string line; is_known_ && std::getline(file, line);) {
      constexpr std::string_view kPeak = "VmHWM:";
      if (line.starts_with(kPeak)) return 1024 * std::strtoull(line.c_str() + kPeak.size(), nullptr, 10);
    }
    return std::nullopt;
  }

 private:
  bool is_known_ = false;
};

class LogBench {
 public:
  LogBench(const LogBenchJob& job, const std::function<bool()>& stop)
      : job_(job), stop_(stop), folder_("gdtslam-bench", ::access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "") {}

  std::vector<LogBenchRow> run() {
    write_files();
    std::vector<LogBenchRow> rows;
    rows.reserve(kLogKinds.size());
    for (const LogKind& kind : kLogKinds) rows.push_back(row_of(kind));
    for (LogBenchRow& row : rows) row.floor_s = floor_seconds(row);
    return rows;
  }
  [[nodiscard]] std::uint64_t scans() const { return scans_; }

 private:
  [[nodiscard]] std::string path(std::string_view file) const { return folder_.path() + "/" + std::string(file); }
  [[nodiscard]] std::uint64_t size(std::string_view file) const { return std::filesystem::file_size(path(file)); }
  void check() const {
    if (stop_()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is printed");
  }

  // As many scans as make an unpacked MCAP file of that size.
  void write_files() {
    AtomicFileSet files;
    std::vector<std::unique_ptr<LogWriter>> writers;
    writers.reserve(kLogKinds.size());
    std::size_t ruler = 0;
    for (const LogKind& kind : kLogKinds) {
      if (kind.file == "none.mcap") ruler = writers.size();
      writers.push_back(make_log_writer(kind.format, path(kind.file), {.packing = kind.chunks}, files));
    }
    BenchDrive drive;
    for (; static_cast<double>(writers[ruler]->bytes()) < kMega * job_.megabytes || scans_ == 0; ++scans_) {
      check();
      for (const LogRecord& record : {BenchDrive::odometry(scans_), drive.scan(scans_)}) {
        for (const auto& writer : writers) writer->write(record);
      }
    }
    for (const auto& writer : writers) writer->finish();
    files.commit();
  }

  void read(const LogKind& kind) const {
    const std::unique_ptr<LogReader> reader = open_log(path(kind.file), {});
    std::uint64_t scans = 0;
    while (const std::optional<LogRecord> record = reader->next()) {
      const auto* const scan = std::get_if<ScanRecord>(&*record);
      scans += scan != nullptr && scan->scan.ranges_m.size() == kDriveBeams ? 1U : 0U;
    }
    if (scans != scans_) throw Error(ExitCode::kFailed, "bench: a log did not come back whole");
  }

  // What cat does.
  void read_plainly(const LogKind& kind) const {
    const std::unique_ptr<ByteSource> source = open_file_source(path(kind.file));
    std::vector<char> piece(kPieceBytes);
    while (source->read(piece) > 0) {
    }
  }

  LogBenchRow row_of(const LogKind& kind) const {
    check();
    LogBenchRow row{.kind = &kind, .file_bytes = size(kind.file)};
    row.bytes = size(kind.plain.empty() ? kind.file : kind.plain);
    const PeakMemory peak;
    row.read = measure({.step = [&] { read(kind); }}, job_.timing);
    row.peak_bytes = peak.bytes();
    row.plain = measure({.step = [&] { read_plainly(kind); }}, job_.timing);
    return row;
  }

  // The file's beginning, unpacked, in pieces as long as a chunk.
  [[nodiscard]] std::vector<std::string> pieces_of(std::string_view file) const {
    const std::unique_ptr<ByteSource> source = open_file_source(path(file));
    std::vector<std::string> pieces;
    std::string piece(kPieceBytes, '\0');
    while (pieces.size() * kPieceBytes < kMostFloorBytes) {
      const std::size_t count = source->read(piece);
      if (count == 0) break;
      pieces.emplace_back(piece.data(), count);
    }
    return pieces;
  }

  double floor_seconds(const LogBenchRow& row) const {
    check();
    const LogKind& kind = *row.kind;
    std::vector<std::string> pieces =
        pieces_of(kind.floor == Floor::kGzip || kind.plain.empty() ? kind.file : kind.plain);
    std::uint64_t bytes = 0;
    for (const std::string& piece : pieces) bytes += piece.size();
    if (kind.floor == Floor::kChecksum) {
      return scaled(row, bytes, [&pieces, sum = checksum(pieces)] {
        if (checksum(pieces) != sum) throw Error(ExitCode::kFailed, "bench: a checksum is not the same again");
      });
    }
    if (kind.floor == Floor::kGzip) {
      std::string whole;
      for (const std::string& piece : pieces) whole += piece;
      return scaled(row, bytes * row.bytes / row.file_bytes, [&] { gunzip(whole); });
    }
    for (std::string& piece : pieces) {
      piece = packed_chunk(piece, kind.floor == Floor::kLz4 ? ChunkPacking::kLz4 : ChunkPacking::kZstd);
    }
    return scaled(row, bytes, [&] { unpack(pieces, kind.packing); });
  }

  double scaled(const LogBenchRow& row, std::uint64_t bytes, std::function<void()> step) const {
    const double taken_s = measure({.step = std::move(step)}, job_.timing).cpu_s;
    return taken_s * static_cast<double>(row.bytes) / static_cast<double>(bytes);
  }

  static uLong checksum(const std::vector<std::string>& pieces) {
    uLong sum = ::crc32(0, nullptr, 0);
    for (const std::string& piece : pieces) {
      sum = ::crc32(sum, reinterpret_cast<const Bytef*>(piece.data()), static_cast<uInt>(piece.size()));
    }
    return sum;
  }

  static void drain(ByteSource& source) {
    std::vector<char> target(kPieceBytes);
    while (source.read(target) > 0) {
    }
  }

  static void unpack(const std::vector<std::string>& pieces, std::string_view packing) {
    for (const std::string& piece : pieces) {
      drain(*unpacked_chunk(open_memory_source(std::as_bytes(std::span(piece))), packing, ""));
    }
  }

  static void gunzip(const std::string& packed) {
    drain(*gunzip_if_packed(open_memory_source(std::as_bytes(std::span(packed))), "bench"));
  }

  LogBenchJob job_;
  std::function<bool()> stop_;
  TemporaryFolder folder_;
  std::uint64_t scans_ = 0;
};

double mega_per_s(std::uint64_t bytes, double seconds) { return static_cast<double>(bytes) / kMega / seconds; }

std::string_view floor_name(Floor floor) {
  constexpr std::array<std::string_view, 4> kFloorNames{"crc32", "lz4", "zstd", "gzip"};
  return kFloorNames.at(static_cast<std::size_t>(floor));
}

constexpr std::string_view kLogColumns =
    "{:<14} {:<5} {:>8} {:>8} {:>8} {:>15} | {:>9} {:>6} | {:>5} {:>8} {:>6} | {:>7}\n";

std::string log_row_text(const LogBenchRow& row) {
  const auto speed = [&row](double seconds) { return fmt::format("{:.0f}", mega_per_s(row.bytes, seconds)); };
  const auto mega = [](std::uint64_t bytes) { return fmt::format("{:.1f}", static_cast<double>(bytes) / kMega); };
  const auto times = [&row](double seconds) { return fmt::format("{:.1f}", row.read.cpu_s / seconds); };
  return fmt::format(kLogColumns, row.kind->name, row.kind->packing, mega(row.file_bytes), mega(row.bytes),
                     speed(row.read.cpu_s), speed(row.read.slowest_s) + "-" + speed(row.read.fastest_s),
                     speed(row.plain.cpu_s), times(row.plain.cpu_s), floor_name(row.kind->floor), speed(row.floor_s),
                     times(row.floor_s), row.peak_bytes ? mega(*row.peak_bytes) : "-");
}

std::string logs_text(const LogBench& bench, const std::vector<LogBenchRow>& rows, const Backend& backend) {
  std::string text = fmt::format("gdtslam {}\ncpu       {}, one thread\n", GDTSLAM_VERSION, backend.device().name);
  text += fmt::format("a drive of {} scans of {} beams, odometry with each\n", bench.scans(), kDriveBeams);
  text += fmt::format(kLogColumns, "", "", "file MB", "MB", "MB/s", "spread", "cat MB/s", "x cat", "alone", "MB/s",
                      "x that", "peak MB");
  for (const LogBenchRow& row : rows) text += log_row_text(row);
  text +=
      "MB/s: 1e6 bytes, unpacked, per CPU second. cat: the file's bytes read and nothing done with them. alone: a "
      "checksum of\nthe bytes, or their decompression, in memory. x: time of the reader over that. peak: the most "
      "memory of the process.\n";
  return text;
}

std::string logs_json(const LogBench& bench, const std::vector<LogBenchRow>& rows, const Backend& backend) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const LogBenchRow& row : rows) {
    list.push_back({{"format", row.kind->name},
                    {"packing", row.kind->packing},
                    {"file_bytes", row.file_bytes},
                    {"bytes", row.bytes},
                    {"samples", row.read.samples},
                    {"read_s", row.read.cpu_s},
                    {"read_fastest_s", row.read.fastest_s},
                    {"read_slowest_s", row.read.slowest_s},
                    {"read_wall_s", row.read.wall_s},
                    {"bytes_per_s", static_cast<double>(row.bytes) / row.read.cpu_s},
                    {"cat_s", row.plain.cpu_s},
                    {"times_cat", row.read.cpu_s / row.plain.cpu_s},
                    {"alone", floor_name(row.kind->floor)},
                    {"alone_s", row.floor_s},
                    {"times_alone", row.read.cpu_s / row.floor_s},
                    {"peak_bytes", row.peak_bytes ? nlohmann::ordered_json(*row.peak_bytes) : nullptr}});
  }
  return json_text({{"version", GDTSLAM_VERSION},
                    {"device", backend.device().name},
                    {"scans", bench.scans()},
                    {"beams", kDriveBeams},
                    {"rows", list}});
}

}  // namespace

std::string bench_logs(const LogBenchJob& job, const Backend& backend, const std::function<bool()>& stop,
                       bool is_json) {
  LogBench bench(job, stop);
  const std::vector<LogBenchRow> rows = bench.run();
  return is_json ? logs_json(bench, rows, backend) : logs_text(bench, rows, backend);
}

}  // namespace gdtslam
