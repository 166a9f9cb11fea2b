// What the tests of io share: folders of their own, files, packed bytes, bounded runs.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/logs/carmen.hpp"
#include "gdtslam/core/stream.hpp"
#include "support/real_data.hpp"

namespace gdtslam::test {

/// A folder that lives as long as the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "gdtslam-io-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw std::runtime_error("no temporary folder");
    }
    path_ = pattern;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
      names.push_back(entry.path().filename().string());
    }
    return names;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace gdtslam::test

namespace gdtslam {

using test::TemporaryFolder;

inline void put_file(const std::string& path, std::string_view text) { std::ofstream(path, std::ios::binary) << text; }

inline std::string get_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline std::string gzip(std::string_view text) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16;
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string packed(deflateBound(&stream, static_cast<uLong>(text.size())) + 64, '\0');
  std::string copy(text);
  stream.next_in = reinterpret_cast<Bytef*>(copy.data());
  stream.avail_in = static_cast<uInt>(copy.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

/// Everything that a log gives.
struct WholeLog {
  std::vector<LogRecord> records;
  std::vector<LogReader::Warning> warnings;

  template <class T>
  [[nodiscard]] std::vector<T> of() const {
    std::vector<T> found;
    for (const LogRecord& record : records) {
      if (const T* value = std::get_if<T>(&record)) {
        found.push_back(*value);
      }
    }
    return found;
  }
  [[nodiscard]] std::uint64_t warned(std::string_view kind) const {
    for (const LogReader::Warning& warning : warnings) {
      if (warning.kind == kind) {
        return warning.count;
      }
    }
    return 0;
  }
};

inline WholeLog drain(LogReader& reader) {
  WholeLog log;
  while (std::optional<LogRecord> record = reader.next()) {
    log.records.push_back(std::move(*record));
  }
  log.warnings = reader.warnings();
  return log;
}

/// Bytes as a log, plain or packed by gzip.
inline std::unique_ptr<ByteSource> source_of(std::span<const std::byte> data) {
  return gunzip_if_packed(open_memory_source(data), "test");
}

inline WholeLog read_text(std::string_view text, const ReadOptions& options = {}) {
  return drain(*open_carmen(source_of(bytes_of(text)), "test.log", options));
}

/// What a call in a process of its own took.
struct BoundedRun {
  bool exited = false;  ///< false when a signal ended it
  int code = -1;
  double cpu_s = 0.0;
  double peak_mb = 0.0;
};

#if defined(GDTSLAM_SANITIZE_ADDRESS) || defined(GDTSLAM_SANITIZE_THREAD)
inline constexpr bool kIsInstrumented = true;  // time and memory are the sanitizer's then
#else
inline constexpr bool kIsInstrumented = false;
#endif

/// Runs `call` in a forked process, so that its time and memory are its own; its result is the exit code.
template <class Call>
BoundedRun run_alone(Call call) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::_exit(call());
  }
  int status = 0;
  rusage usage{};
  EXPECT_EQ(::wait4(child, &status, 0, &usage), child);
  BoundedRun run;
  run.exited = WIFEXITED(status);
  run.code = run.exited ? WEXITSTATUS(status) : -1;
  run.cpu_s = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
              1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  run.peak_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return run;
}

/// What the `Failure` says that `action` ends with; `otherwise` where it ends without one. Others go through.
template <class Failure, class Action>
std::string told_by(const Action& action, const std::string& otherwise = "") {
  try {
    action();
  } catch (const Failure& failure) {
    return failure.what();
  }
  return otherwise;
}

inline void expect_bounded(const BoundedRun& run) {
  EXPECT_TRUE(run.exited);
  if (!kIsInstrumented) {
    EXPECT_LT(run.cpu_s, 1.0);
    EXPECT_LT(run.peak_mb, 256.0);
  }
}

}  // namespace gdtslam
