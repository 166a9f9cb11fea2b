// How fast logs are read, of every format: a drive is written by our own writers and read again, beside the file's
// bytes alone and beside a checksum of them, or their decompression, alone.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/elementary.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/recordings/containers/chunk.hpp"
#include "engine/io/writers/log_writer.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/io/log.hpp"
#include "rows.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

constexpr double kMega = 1e6;
constexpr std::size_t kDriveBeams = 720;
constexpr std::size_t kPieceBytes = std::size_t{1} << 20U;
constexpr std::size_t kMostFloorBytes = std::size_t{64} << 20U;  // of a file, that are kept for what goes on in memory

struct LogKind {
  std::string_view name;
  std::string_view packing;
  std::string_view file;
  LogFormat format;
  std::optional<ChunkPacking> chunks;
  std::string_view plain;  ///< the file of the same bytes unpacked; none: itself
};
constexpr std::array<LogKind, 7> kLogKinds{{
    {"MCAP", "none", "none.mcap", LogFormat::kMcap, ChunkPacking::kNone, ""},
    {"MCAP", "lz4", "lz4.mcap", LogFormat::kMcap, ChunkPacking::kLz4, "none.mcap"},
    {"MCAP", "zstd", "zstd.mcap", LogFormat::kMcap, ChunkPacking::kZstd, "none.mcap"},
    {"CSV", "none", "drive.csv", LogFormat::kCsv, std::nullopt, ""},
    {"JSON lines", "none", "drive.jsonl", LogFormat::kJsonLines, std::nullopt, ""},
    {"CARMEN", "none", "drive.log", LogFormat::kCarmen, std::nullopt, ""},
    {"CARMEN", "gzip", "drive.log.gz", LogFormat::kCarmen, std::nullopt, "drive.log"},
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

/// The drive in every format.
class LogFiles {
 public:
  // As many scans as make an unpacked MCAP file of that size.
  explicit LogFiles(double megabytes) {
    AtomicFileSet files;
    std::vector<std::unique_ptr<LogWriter>> writers;
    writers.reserve(kLogKinds.size());
    std::size_t ruler = 0;
    for (const LogKind& kind : kLogKinds) {
      if (kind.file == "none.mcap") ruler = writers.size();
      writers.push_back(make_log_writer(kind.format, path(kind.file), kind.chunks, files));
    }
    BenchDrive drive;
    for (; static_cast<double>(writers[ruler]->bytes()) < kMega * megabytes || scans_ == 0; ++scans_) {
      if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted");
      for (const LogRecord& record : {BenchDrive::odometry(scans_), drive.scan(scans_)}) {
        for (const auto& writer : writers) writer->write(record);
      }
    }
    for (const auto& writer : writers) writer->finish();
    files.commit();
  }
  [[nodiscard]] std::string path(std::string_view file) const { return folder_.path() + "/" + std::string(file); }
  [[nodiscard]] std::uint64_t size(std::string_view file) const { return std::filesystem::file_size(path(file)); }
  /// Of the file, unpacked.
  [[nodiscard]] std::uint64_t bytes(const LogKind& kind) const {
    return size(kind.plain.empty() ? kind.file : kind.plain);
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

  /// The file's beginning, in pieces as long as a chunk.
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

 private:
  TemporaryFolder folder_{"gdtslam-bench", bench_folder()};
  std::uint64_t scans_ = 0;
};

// What cat does, too.
void drain(ByteSource& source) {
  std::vector<char> target(kPieceBytes);
  while (source.read(target) > 0) {
  }
}

void set_bytes(benchmark::State& state, double bytes) {
  state.SetBytesProcessed(static_cast<std::int64_t>(static_cast<double>(state.iterations()) * bytes));
}

void measure_read(benchmark::State& state, const LogFiles& files, const LogKind& kind) {
  const PeakMemory peak;
  for (auto _ : state) files.read(kind);
  set_bytes(state, static_cast<double>(files.bytes(kind)));
  state.counters["bytes"] = static_cast<double>(files.bytes(kind));
  state.counters["file_bytes"] = static_cast<double>(files.size(kind.file));
  if (const std::optional<std::uint64_t> bytes = peak.bytes())
    state.counters["peak_bytes"] = static_cast<double>(*bytes);
}

void measure_checksum(benchmark::State& state, const LogFiles& files, const LogKind& kind) {
  const std::vector<std::string> pieces = files.pieces_of(kind.file);
  std::size_t bytes = 0;
  for (const std::string& piece : pieces) bytes += piece.size();
  for (auto _ : state) {
    uLong sum = ::crc32(0, nullptr, 0);
    for (const std::string& piece : pieces) {
      sum = ::crc32(sum, reinterpret_cast<const Bytef*>(piece.data()), static_cast<uInt>(piece.size()));
    }
    benchmark::DoNotOptimize(sum);
  }
  set_bytes(state, static_cast<double>(bytes));
}

void measure_gunzip(benchmark::State& state, const LogFiles& files, const LogKind& kind) {
  std::string packed;
  for (const std::string& piece : files.pieces_of(kind.file)) packed += piece;
  for (auto _ : state) drain(*gunzip_if_packed(open_memory_source(std::as_bytes(std::span(packed))), "bench"));
  const double unpacked = static_cast<double>(files.bytes(kind)) / static_cast<double>(files.size(kind.file));
  set_bytes(state, static_cast<double>(packed.size()) * unpacked);
}

void measure_unpacking(benchmark::State& state, const LogFiles& files, const LogKind& kind) {
  std::vector<std::string> pieces = files.pieces_of(kind.plain);
  std::size_t bytes = 0;
  for (std::string& piece : pieces) {
    bytes += piece.size();
    piece = packed_chunk(piece, *kind.chunks);
  }
  for (auto _ : state) {
    for (const std::string& piece : pieces) {
      drain(*unpacked_chunk(open_memory_source(std::as_bytes(std::span(piece))), kind.packing, ""));
    }
  }
  set_bytes(state, static_cast<double>(bytes));
}

}  // namespace

void add_log_formats(const BenchTarget& cpu, double megabytes) {
  const auto files = shared_by_rows([megabytes] { return std::make_shared<LogFiles>(megabytes); });
  for (const LogKind& kind : kLogKinds) {
    const std::string variant = std::string(kind.name) + ", " + std::string(kind.packing);
    add_row(cpu, "log", "read", variant,
            [files, &kind](benchmark::State& state) { measure_read(state, files(), kind); });
    add_row(cpu, "log", "cat", variant, [files, &kind](benchmark::State& state) {
      for (auto _ : state) drain(*open_file_source(files().path(kind.file)));
      set_bytes(state, static_cast<double>(files().bytes(kind)));
    });
    const auto alone = kind.packing == "gzip"   ? measure_gunzip
                       : kind.packing == "none" ? measure_checksum
                                                : measure_unpacking;
    add_row(cpu, "log", "alone", variant,
            [files, &kind, alone](benchmark::State& state) { alone(state, files(), kind); });
  }
}

}  // namespace gdtslam
