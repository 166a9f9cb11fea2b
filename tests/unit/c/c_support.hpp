// What the tests of the C interface share: the sample log, the hashes that it must give, and handles that free
// themselves.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "gdtslam.h"

namespace gdtslam::c {

inline const std::string kSampleLog = GDTSLAM_SOURCE_DIR "/assets/logs/office-start.log.gz";

struct FreeHandle {
  void operator()(gdtslam_options* handle) const { gdtslam_options_free(handle); }
  void operator()(gdtslam_reader* handle) const { gdtslam_reader_free(handle); }
  void operator()(gdtslam_mapper* handle) const { gdtslam_mapper_free(handle); }
  void operator()(gdtslam_grid* handle) const { gdtslam_grid_free(handle); }
  void operator()(gdtslam_run* handle) const { gdtslam_run_free(handle); }
  void operator()(gdtslam_bytes* handle) const { gdtslam_bytes_free(handle); }
  void operator()(gdtslam_localizer* handle) const { gdtslam_localizer_free(handle); }
  void operator()(gdtslam_tracker* handle) const { gdtslam_tracker_free(handle); }
};
template <class Handle>
using Owned = std::unique_ptr<Handle, FreeHandle>;

/// A folder that goes with the test.
class TempDir {
 public:
  TempDir() {
    std::string name = (std::filesystem::temp_directory_path() / "gdtslam_c_XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;
  ~TempDir() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A struct of the interface, ready to be filled in.
template <class Struct>
Struct made() {
  Struct value;
  GDTSLAM_INIT(value);
  return value;
}

/// The hashes that ship with the sample log: of the run with or without loops.
struct SampleHashes {
  std::string map;
  std::string trajectory;
};
inline SampleHashes sample_hashes(bool with_loops) {
  std::ifstream file(GDTSLAM_SOURCE_DIR "/assets/expected/office-start.json");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::size_t at = text.find(R"("matcher": "gauss-newton")");
  if (with_loops) at = text.find(R"("loops": true)", at);
  const auto value = [&text, at](const std::string& key) {
    const std::string mark = "\"" + key + "\": \"";
    return text.substr(text.find(mark, at) + mark.size(), 64);
  };
  return {value("map_sha256"), value("trajectory_sha256")};
}

/// A scan of the sample log with the room for its ranges.
struct KeptScan {
  gdtslam_scan scan;
  std::vector<float> ranges;
  [[nodiscard]] gdtslam_scan view() const {
    gdtslam_scan view = scan;
    view.ranges_m = ranges.data();
    return view;
  }
};
inline std::vector<KeptScan> sample_scans() {
  std::vector<KeptScan> scans;
  gdtslam_reader* opened = nullptr;
  const char* const log = kSampleLog.c_str();
  if (gdtslam_reader_open(&log, 1, nullptr, 0, &opened, nullptr) != GDTSLAM_OK) return scans;
  const Owned<gdtslam_reader> reader(opened);
  int32_t has_scan = 0;
  for (;;) {
    auto scan = made<gdtslam_scan>();
    if (gdtslam_reader_next(reader.get(), &scan, &has_scan, nullptr) != GDTSLAM_OK || has_scan == 0) return scans;
    scans.push_back({scan, {scan.ranges_m, scan.ranges_m + scan.range_count}});
  }
}

}  // namespace gdtslam::c
