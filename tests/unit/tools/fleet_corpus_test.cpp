// The corpus of the fuzzer of an atlas' files, replayed with every compiler.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "fuzz/fleet_target.hpp"

namespace gdtslam {
namespace {

TEST(FleetCorpus, EndsInFilesOrATypedError) {
  std::size_t files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(GDTSLAM_SOURCE_DIR) / "tests/fuzz/corpus/fleet")) {
    SCOPED_TRACE(entry.path().string());
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    EXPECT_NO_THROW(fuzz::read_fleet_text(std::as_bytes(std::span(bytes.data(), bytes.size()))));
    ++files;
  }
  EXPECT_GE(files, 8U);
}

}  // namespace
}  // namespace gdtslam
