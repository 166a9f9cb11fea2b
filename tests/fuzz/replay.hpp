// A target's corpus, replayed with every compiler: each input ends in a record, a file or a typed error.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <string>
#include <vector>

#include "target.hpp"

namespace gdtslam::fuzz {

inline void PrintTo(const FuzzTarget& target, std::ostream* stream) { *stream << target.name; }

inline void replay_corpus(const FuzzTarget& target) {
  const std::filesystem::path folder = std::filesystem::path(GDTSLAM_SOURCE_DIR) / "tests/fuzz/corpus" / target.name;
  std::size_t inputs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().string());
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    EXPECT_NO_THROW(target.read(bytes_of(bytes)));
    ++inputs;
  }
  EXPECT_GE(inputs, target.fewest) << folder;
}

/// What ctest calls the target's test.
inline std::string name_of_test(const testing::TestParamInfo<FuzzTarget>& info) { return std::string(info.param.name); }

}  // namespace gdtslam::fuzz
