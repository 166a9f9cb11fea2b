#include "log_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "carmen_log.hpp"
#include "engine/io/did_you_mean.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "mcap_writer.hpp"
#include "ros1_bag_writer.hpp"
#include "ros2_database.hpp"
#include "ros_log.hpp"
#include "table_log.hpp"

namespace gdtslam {
namespace {

struct LogEnding {
  std::string_view ending;
  std::string_view name;
  LogFormat format;
};
constexpr std::array<LogEnding, 8> kLogEndings{{{".log", "carmen", LogFormat::kCarmen},
                                                {".clf", "carmen", LogFormat::kCarmen},
                                                {".csv", "csv", LogFormat::kCsv},
                                                {".jsonl", "jsonl", LogFormat::kJsonLines},
                                                {".mcap", "mcap", LogFormat::kMcap},
                                                {".bag", "bag", LogFormat::kBag},
                                                {"/", "ros2", LogFormat::kRos2Folder},
                                                {".db3", "db3", LogFormat::kDb3}}};

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  names.reserve(kLogEndings.size());
  for (const LogEnding& one : kLogEndings) {
    if (names.empty() || names.back() != one.name) names.emplace_back(one.name);
  }
  return names;
}

bool is_stream(LogFormat format) {
  return format != LogFormat::kBag && format != LogFormat::kRos2Folder && format != LogFormat::kDb3;
}

void check_place(LogFormat format, const std::string& path) {
  if (is_stream(format)) return;
  if (path == "-") {
    throw UsageError("-o -: carmen, csv, jsonl and mcap can go to standard output; give a file");
  }
  if (path.ends_with(".gz")) {
    throw UsageError(fmt::format("{}: a bag is not packed from outside; leave out .gz (--compression packs chunks)",
                                 one_line(path)));
  }
}

ChunkPacking packing_of(LogFormat format, const LogWriteOptions& options) {
  const bool is_bag = format == LogFormat::kBag;
  const bool is_mcap = format == LogFormat::kMcap;
  const ChunkPacking packing = options.packing.value_or(is_mcap ? ChunkPacking::kZstd : ChunkPacking::kNone);
  const bool is_missing = is_bag ? packing == ChunkPacking::kZstd : is_mcap ? packing == ChunkPacking::kBz2 : false;
  if (is_missing || (options.packing && !is_bag && !is_mcap)) {
    throw UsageError(
        "--compression: bags take none, bz2 and lz4, MCAP files none, lz4 and zstd, other formats nothing");
  }
  return packing;
}

}  // namespace

std::string log_format_names() { return fmt::format("{}", fmt::join(format_names(), ", ")); }

std::optional<LogFormat> log_format_by_ending(const std::string& path) {
  for (const LogEnding& one : kLogEndings) {
    if (path.ends_with(one.ending) || path.ends_with(std::string(one.ending) + ".gz")) return one.format;
  }
  return std::nullopt;
}

LogFormat log_format_of(const std::string& path, const std::string& name) {
  if (const auto format = name.empty() ? log_format_by_ending(path) : std::nullopt) return *format;
  if (!name.empty()) {
    const auto* const found = std::find_if(kLogEndings.begin(), kLogEndings.end(),
                                           [&name](const LogEnding& one) { return one.name == name; });
    if (found != kLogEndings.end()) return found->format;
    throw UsageError(fmt::format("--format: there is no {}{}; there are {}", in_quotes(name),
                                 did_you_mean(name, format_names()), log_format_names()));
  }
  throw UsageError(
      fmt::format("{}: its name does not tell the format: let it end in .log, .clf, .csv, .jsonl, .mcap, .bag, .db3 "
                  "or a slash (a ROS 2 folder), or give --format",
                  one_line(path)));
}

std::vector<std::string> files_of_log(LogFormat format, const std::string& path) {
  if (format != LogFormat::kRos2Folder) return {path};
  return {ros2_database_of(path),
          (std::filesystem::path(ros2_database_of(path)).parent_path() / kRos2Metadata).string()};
}

std::unique_ptr<LogWriter> make_log_writer(LogFormat format, const std::string& path, const LogWriteOptions& options,
                                           AtomicFileSet& files) {
  check_place(format, path);
  const ChunkPacking packing = packing_of(format, options);
  const auto file = [&]() -> AtomicFile& { return files.add(path == "-" ? "/dev/stdout" : path); };
  switch (format) {
    case LogFormat::kCarmen:
      return std::make_unique<CarmenLog>(file(), options);
    case LogFormat::kCsv:
      return std::make_unique<CsvLog>(file());
    case LogFormat::kJsonLines:
      return std::make_unique<JsonLinesLog>(file());
    case LogFormat::kMcap:
      return std::make_unique<RosLog>(std::make_unique<McapWriter>(file(), packing));
    case LogFormat::kBag:
      return std::make_unique<RosLog>(std::make_unique<Ros1BagWriter>(file(), packing));
    case LogFormat::kRos2Folder:
      return std::make_unique<RosLog>(std::make_unique<Ros2DatabaseWriter>(path, files, true));
    case LogFormat::kDb3:
      break;
  }
  return std::make_unique<RosLog>(std::make_unique<Ros2DatabaseWriter>(path, files, false));
}

}  // namespace gdtslam
