// The corpus of the linkage files' fuzzer, replayed with every compiler.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "fuzz/linkage_target.hpp"

namespace gdtslam {
namespace {

TEST(LinkageCorpus, EndsInALinkageOrATypedError) {
  std::size_t files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(GDTSLAM_SOURCE_DIR) / "tests/fuzz/corpus/linkage")) {
    SCOPED_TRACE(entry.path().string());
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    EXPECT_NO_THROW(fuzz::read_linkage(std::as_bytes(std::span(text.data(), text.size()))));
    ++files;
  }
  EXPECT_GE(files, 12U);
}

}  // namespace
}  // namespace gdtslam
