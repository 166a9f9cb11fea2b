// Completeness: a kernel that lacks any of its parts fails here.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "engine/compute/cases/kernel_cases.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "support/brute_force.hpp"

namespace gdtslam::test {
namespace {

namespace fs = std::filesystem;

TEST(Registry, EveryKernelHasAllItsParts) {
  for (const KernelInfo* kernel : kernel_registry()) {
    SCOPED_TRACE(std::string(kernel->name));
    EXPECT_EQ(kernel->name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), std::string_view::npos);
    EXPECT_FALSE(kernel->bindings.empty());
    const auto writes = [](Access access) { return access != Access::kRead; };
    EXPECT_TRUE(std::any_of(kernel->bindings.begin(), kernel->bindings.end(), writes));
    EXPECT_GT(kernel->params_bytes, 0U);
    EXPECT_LE(kernel->params_bytes, kMaxParamsBytes);
    EXPECT_EQ(kernel->params_bytes % 4, 0U);
    EXPECT_NE(kernel->check, nullptr);
    EXPECT_NE(kernel->work, nullptr);
    EXPECT_FALSE(kernel->work_unit.empty());
    EXPECT_FALSE(kernel->source.empty());
    EXPECT_EQ(find_kernel(kernel->name), kernel);
  }
  EXPECT_EQ(find_kernel("no_such_kernel"), nullptr);
}

TEST(Registry, EveryInstructionSetHasEveryKernel) {
  for (const KernelInfo* kernel : kernel_registry()) {
    EXPECT_NE(kernel->cpu[0], nullptr) << kernel->name;
    for (std::size_t i = 0; i < kIsaCount; ++i) {
      EXPECT_EQ(kernel->cpu[i] != nullptr, kernel_registry().front()->cpu[i] != nullptr) << kernel->name << ' ' << i;
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_TRUE(kernel->cpu[i] == nullptr || kernel->cpu[i] != kernel->cpu[j]) << kernel->name << ' ' << i;
      }
    }
  }
#if defined(__x86_64__)
  EXPECT_NE(kernel_registry().front()->cpu[2], nullptr) << "the build lacks its AVX-512 kernels";
#endif
}

/// "JumpFloodInit" to "jump_flood_init".
std::string snake_case(const std::string& camel) {
  std::string name;
  for (const char c : camel) {
    const bool upper = c >= 'A' && c <= 'Z';
    name += upper && !name.empty() ? "_" : "";
    name += static_cast<char>(upper ? c - 'A' + 'a' : c);
  }
  return name;
}

/// The kernels that the headers declare: structs with a `static const KernelInfo& info();`.
std::set<std::string> declared_kernels() {
  std::set<std::string> names;
  const fs::path folder = fs::path(GDTSLAM_SOURCE_DIR) / "engine/compute/kernels";
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".hpp") continue;
    std::ifstream file(entry.path());
    std::string latest;
    for (std::string line; std::getline(file, line);) {
      if (line.starts_with("struct ") && line.ends_with(" {")) {
        latest = line.substr(7, line.size() - 9);
      } else if (line.find("static const KernelInfo& info();") != std::string::npos) {
        names.insert(snake_case(latest));
      }
    }
  }
  return names;
}

TEST(Registry, HoldsWhatTheHeadersDeclare) {
  std::set<std::string> registered;
  for (const KernelInfo* kernel : kernel_registry()) {
    registered.emplace(kernel->name);
  }
  EXPECT_EQ(registered, declared_kernels());
}

TEST(Registry, EveryKernelHasCasesABenchmarkAndAnOracle) {
  const std::vector<KernelCaseSource> list = kernel_cases();
  for (const KernelInfo* kernel : kernel_registry()) {
    SCOPED_TRACE(std::string(kernel->name));
    std::set<std::string> names;
    bool benchmark = false;
    const KernelCaseSource* first = nullptr;
    for (const KernelCaseSource& source : list) {
      if (source.kernel == kernel) {
        EXPECT_TRUE(names.insert(source.name).second) << "twice: " << source.name;
        benchmark = benchmark || source.benchmark;
        first = first == nullptr ? &source : first;
      }
    }
    EXPECT_GE(names.size(), 10U);
    EXPECT_TRUE(benchmark) << "no case is marked as a benchmark";
    ASSERT_NE(first, nullptr);
    EXPECT_NO_THROW(brute_outcome(first->make()));
  }
}

TEST(KernelCases, FitTheirKernelsAndAreTheSameBytesEachTime) {
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.benchmark || source.large) {
      continue;
    }
    const KernelCase once = source.make();
    const KernelCase again = source.make();
    ASSERT_EQ(once.buffers.size(), source.kernel->bindings.size()) << source.name;
    ASSERT_EQ(once.params, again.params) << source.name;
    for (std::size_t i = 0; i < once.buffers.size(); ++i) {
      const ValueLayout& layout = once.buffers[i].layout;
      ASSERT_EQ(once.buffers[i].content, again.buffers[i].content) << source.name;
      ASSERT_EQ(once.buffers[i].content.size(), std::size_t{layout.stride} * layout.height * layout.value_bytes)
          << source.name;
    }
  }
}

TEST(RandomKernelCases, DrawEveryKernelAndComeBackByTheirNumbers) {
  const std::vector<KernelCaseSource> list = random_kernel_cases(7, 600);
  std::set<std::string_view> drawn;
  std::set<std::string> names;
  for (std::uint32_t i = 0; i < list.size(); ++i) {
    drawn.insert(list[i].kernel->name);
    names.insert(list[i].name);
    if (i % 20 == 0) {
      const KernelCase once = list[i].make();
      const KernelCase again = random_kernel_case(7, i).make();
      EXPECT_EQ(once.name, "random 7/" + std::to_string(i));
      EXPECT_EQ(once.kernel, again.kernel);
      EXPECT_EQ(once.params, again.params);
      for (std::size_t b = 0; b < once.buffers.size(); ++b) {
        EXPECT_EQ(once.buffers[b].content, again.buffers[b].content) << once.name;
      }
    }
  }
  EXPECT_EQ(drawn.size(), kernel_registry().size()) << "a kernel is never drawn";
  EXPECT_EQ(names.size(), list.size());
  EXPECT_NE(random_kernel_case(7, 0).make().params, random_kernel_case(8, 0).make().params);
}

}  // namespace
}  // namespace gdtslam::test
