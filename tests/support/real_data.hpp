// Data that are not part of the project, the public logs first of all: in the folder GDTSLAM_DATA, or in ../shared/data
// beside the clone. A test of them skips, visibly, where there is none, and has a twin on simulated data that never
// does.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace gdtslam::test {

inline std::filesystem::path data_folder() {
  const char* const folder = std::getenv("GDTSLAM_DATA");
  return folder != nullptr ? folder : std::filesystem::path(GDTSLAM_SOURCE_DIR) / "../shared/data";
}

/// The file of that name in the folder, or nothing where there is none.
inline std::optional<std::string> real_data(const std::string& name) {
  const std::filesystem::path file = data_folder() / name;
  return std::filesystem::exists(file) ? std::optional(file.string()) : std::nullopt;
}

/// Whether a missing file is a failure: continuous integration (CI=true) with a folder that should hold it.
inline bool real_data_is_required() {
  const char* const value = std::getenv("CI");
  return value != nullptr && std::string(value) == "true" && std::filesystem::is_directory(data_folder());
}

}  // namespace gdtslam::test

/// At the start of a test: `variable` is the path of the file; where it is missing the test fails or skips.
#define GDTSLAM_REAL_DATA(variable, name)                                                                       \
  const std::optional<std::string> variable##_found = ::gdtslam::test::real_data(name);                         \
  if (!variable##_found && ::gdtslam::test::real_data_is_required())                                            \
    FAIL() << "CI=true and " << (name) << " is not in " << ::gdtslam::test::data_folder();                      \
  if (!variable##_found) GTEST_SKIP() << "NOTHING WAS TESTED: " << (name) << " is not there; set GDTSLAM_DATA"; \
  const std::string variable = *variable##_found
