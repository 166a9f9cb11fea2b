#include "engine/runs/streams/scan_ahead.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// A log of so many scans, stamped 1, 2, 3 ... s; where `bad_line` is one of them it cannot be read.
class ScansInAFile {
 public:
  explicit ScansInAFile(int scans, int bad_line = 0)
      : path_(std::filesystem::temp_directory_path() / ("gdtslam-ahead-" + std::to_string(::getpid()))) {
    std::ofstream file(path_);
    for (int k = 1; k <= scans; ++k) {
      file << (k == bad_line ? "FLASER 3 1.0 x 1.0" : "FLASER 3 1.0 1.1 1.2") << " 0 0 0 0 0 0 " << k << " host " << k
           << '\n';
    }
  }
  ScansInAFile(const ScansInAFile&) = delete;
  ScansInAFile& operator=(const ScansInAFile&) = delete;
  ~ScansInAFile() { std::filesystem::remove(path_); }
  [[nodiscard]] ScanStream stream() const { return ScanStream({path_.string()}, {}, {}); }
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST(ScanAhead, GivesTheScansOfTheLogInTheirOrder) {
  const ScansInAFile log(700);  // several times as many as are read ahead
  for (const bool has_thread : {false, true}) {
    ScanStream stream = log.stream();
    ScanAhead ahead(stream, has_thread);
    double stamp_s = 0.0;
    while (const std::optional<Observation> scans = ahead.next()) EXPECT_EQ(scans->front().scan.stamp_s, ++stamp_s);
    EXPECT_EQ(stamp_s, 700.0);
    EXPECT_FALSE(ahead.next()) << "behind the end is the end";
    ahead.stop();
    EXPECT_EQ(stream.scans_read(), 700U);
    EXPECT_EQ(ahead.cpu_s() > 0.0, has_thread);
  }
}

TEST(ScanAhead, WhatCannotBeReadComesBehindTheScansBeforeIt) {
  const ScansInAFile log(300, 201);
  for (const bool has_thread : {false, true}) {
    ScanStream stream = log.stream();
    ScanAhead ahead(stream, has_thread);
    for (int k = 1; k <= 200; ++k) ASSERT_TRUE(ahead.next()) << k;
    try {
      static_cast<void>(ahead.next());
      FAIL() << "line 201 is no scan";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(":201"), std::string::npos) << error.what();
    }
  }
}

TEST(ScanAhead, CanBeStoppedWhileScansAreLeft) {
  const ScansInAFile log(5000);
  ScanStream stream = log.stream();
  {
    ScanAhead ahead(stream, true);
    EXPECT_TRUE(ahead.next());
    ahead.stop();
  }
  EXPECT_LT(stream.scans_read(), 5000U);
}

}  // namespace
}  // namespace gdtslam
