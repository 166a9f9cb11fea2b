// Tests of what needs programs of others: ffmpeg and ffprobe.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

namespace gdtslam::test {

/// Whether the shell finds all of these programs, named with spaces between them.
inline bool has_programs(const std::string& names) {
  for (std::size_t begin = 0; begin < names.size();) {
    const std::size_t end = std::min(names.find(' ', begin), names.size());
    if (std::system(("command -v " + names.substr(begin, end - begin) + " >/dev/null 2>&1").c_str()) != 0) return false;
    begin = end + 1;
  }
  return true;
}

/// Whether a missing program is a failure (GDTSLAM_REQUIRE_PROGRAMS=1).
inline bool programs_are_required() {
  const char* const value = std::getenv("GDTSLAM_REQUIRE_PROGRAMS");
  return value != nullptr && std::string(value) == "1";
}

}  // namespace gdtslam::test

/// At the start of a test: where one of the programs is missing the test fails if they are required, else it skips.
#define GDTSLAM_NEEDS_PROGRAMS(names)                                             \
  do {                                                                            \
    if (!::gdtslam::test::has_programs(names)) {                                  \
      if (::gdtslam::test::programs_are_required()) {                             \
        FAIL() << "GDTSLAM_REQUIRE_PROGRAMS=1 and not all there of: " << (names); \
      }                                                                           \
      GTEST_SKIP() << "NOTHING WAS TESTED: not all there of: " << (names);        \
    }                                                                             \
  } while (false)
