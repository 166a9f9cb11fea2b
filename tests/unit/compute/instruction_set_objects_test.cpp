// The objects of the instruction sets must not define anything that the linker could share with the rest of the
// program: an inline function compiled for AVX-512 would then run, and crash, on every other processor.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace gdtslam::test {
namespace {

/// Lines that a command prints; empty when it fails.
std::vector<std::string> output_of(const std::string& command) {
  struct Close {
    void operator()(std::FILE* pipe) const { pclose(pipe); }
  };
  const std::unique_ptr<std::FILE, Close> pipe(popen(command.c_str(), "r"));
  std::vector<std::string> lines;
  std::array<char, 4096> line{};
  while (pipe != nullptr && std::fgets(line.data(), line.size(), pipe.get()) != nullptr) {
    lines.emplace_back(line.data());
    if (!lines.back().empty() && lines.back().back() == '\n') {
      lines.back().pop_back();
    }
  }
  return lines;
}

/// Kinds of symbols that other objects see, as nm writes them: text, data, weak, unique.
constexpr std::string_view kVisible = "ABCDGRSTVWu";

TEST(InstructionSetObjects, DefineOnlyTheirTables) {
  const std::filesystem::path library =
      std::filesystem::path(GDTSLAM_BINARY_DIR) / "engine/compute/libgdtslam_compute.a";
  ASSERT_TRUE(std::filesystem::exists(library)) << library;
  std::string object;
  std::vector<std::string> tables;
  const std::vector<std::string> lines = output_of("nm -C --defined-only '" + library.string() + "'");
  ASSERT_FALSE(lines.empty()) << "nm printed nothing: binutils is needed";
  for (const std::string& line : lines) {
    if (!line.empty() && line.back() == ':') {
      object = line.substr(0, line.size() - 1);
    }
    const bool of_an_isa = object == "baseline.cpp.o" || object == "avx2.cpp.o" || object == "avx512.cpp.o";
    if (!of_an_isa || line.size() < 20 || kVisible.find(line[17]) == std::string_view::npos) {
      continue;
    }
    const std::string name = line.substr(19);
    if (name.starts_with("__odr_asan") || name.starts_with("DW.ref.")) {
      continue;  // data of the sanitizers: no code that another object could call
    }
    if (name.ends_with("Functions")) {
      tables.push_back(name);
    } else {
      ADD_FAILURE() << object << " defines " << name << " (" << line[17] << "), which others may use";
    }
  }
#if defined(__x86_64__)
  EXPECT_EQ(tables.size(), 3U);
#else
  EXPECT_EQ(tables.size(), 1U);
#endif
}

}  // namespace
}  // namespace gdtslam::test
