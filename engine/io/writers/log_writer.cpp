#include "log_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/io/did_you_mean.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "log_formats.hpp"

namespace gdtslam {
namespace {

struct LogEnding {
  std::string_view ending;
  std::string_view name;
  LogFormat format;
};
constexpr std::array<LogEnding, 5> kLogEndings{{{".log", "carmen", LogFormat::kCarmen},
                                                {".clf", "carmen", LogFormat::kCarmen},
                                                {".csv", "csv", LogFormat::kCsv},
                                                {".jsonl", "jsonl", LogFormat::kJsonLines},
                                                {".mcap", "mcap", LogFormat::kMcap}}};

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  names.reserve(kLogEndings.size());
  for (const LogEnding& one : kLogEndings) {
    if (names.empty() || names.back() != one.name) names.emplace_back(one.name);
  }
  return names;
}

// These are read and not written: MCAP files hold the same messages.
void refuse_bags(const std::string& path) {
  for (const std::string_view ending : {".bag", ".bag.gz", ".db3", ".db3.gz", "/"}) {
    if (!path.ends_with(ending)) continue;
    throw UsageError(
        fmt::format("{}: bags of ROS 1 and folders and databases of ROS 2 are read, not written; write an .mcap file, "
                    "of which rosbags-convert (Python package rosbags) makes a bag",
                    one_line(path)));
  }
}

}  // namespace

std::string log_format_names() { return fmt::format("{}", fmt::join(format_names(), ", ")); }

std::optional<LogFormat> log_format_by_ending(const std::string& path) {
  refuse_bags(path);
  for (const LogEnding& one : kLogEndings) {
    if (path.ends_with(one.ending) || path.ends_with(std::string(one.ending) + ".gz")) return one.format;
  }
  return std::nullopt;
}

LogFormat find_log_format(const std::string& path, const std::string& name) {
  if (const auto format = name.empty() ? log_format_by_ending(path) : std::nullopt) return *format;
  if (!name.empty()) {
    const auto* const found = std::find_if(kLogEndings.begin(), kLogEndings.end(),
                                           [&name](const LogEnding& one) { return one.name == name; });
    if (found != kLogEndings.end()) return found->format;
    throw UsageError(fmt::format("--format: there is no {}{}; there are {}", in_quotes(name),
                                 did_you_mean(name, format_names()), log_format_names()));
  }
  throw UsageError(
      fmt::format("{}: its name does not tell the format: let it end in .log, .clf, .csv, .jsonl or .mcap, or give "
                  "--format",
                  one_line(path)));
}

std::unique_ptr<LogWriter> make_log_writer(LogFormat format, const std::string& path,
                                           std::optional<ChunkPacking> packing, AtomicFileSet& files) {
  if (packing && format != LogFormat::kMcap) {
    throw UsageError("--compression: MCAP files take none, lz4 and zstd, other formats nothing");
  }
  AtomicFile& file = files.add(path == "-" ? "/dev/stdout" : path);
  switch (format) {
    case LogFormat::kCarmen:
      return make_carmen_log(file);
    case LogFormat::kCsv:
      return make_csv_log(file);
    case LogFormat::kJsonLines:
      return make_json_lines_log(file);
    case LogFormat::kMcap:
      break;
  }
  return make_ros_log(file, packing.value_or(ChunkPacking::kZstd));
}

}  // namespace gdtslam
