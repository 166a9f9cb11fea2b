// The same bytes whatever the number of threads, and whatever slices a kernel is cut into.
#include <gtest/gtest.h>

#include "engine/compute/cases/kernel_cases.hpp"
#include "gdtslam/core/random.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

TEST(ThreadCount, DoesNotChangeAByteOfTheLargeCases) {
  const auto single = make_cpu_backend({.threads = 1, .isa = std::nullopt});
  std::vector<std::unique_ptr<Backend>> others;
  for (const unsigned threads : {2U, 3U, 7U}) {
    others.push_back(make_cpu_backend({.threads = threads, .isa = std::nullopt}));
  }
  for (const KernelCaseSource& source : kernel_cases()) {
    if (!source.benchmark && !source.large) {
      continue;
    }
    const KernelCase kernel_case = source.make();
    const CaseOutcome expected = run_case(*single, kernel_case);
    for (const auto& other : others) {
      if (source.large && other != others.back()) {
        continue;  // once is enough
      }
      EXPECT_TRUE(run_case(*other, kernel_case).contents == expected.contents)
          << source.kernel->name << ' ' << source.name << ' ' << other->device().threads << " threads";
    }
  }
}

std::vector<std::vector<std::byte>> run_sliced(const KernelCase& kernel_case, Isa isa, Random& random) {
  std::vector<std::vector<std::byte>> contents;
  std::vector<std::span<std::byte>> spans;
  for (const CaseBuffer& buffer : kernel_case.buffers) {
    contents.push_back(buffer.content);
  }
  for (std::vector<std::byte>& content : contents) {
    spans.emplace_back(content);
  }
  const std::uint32_t count = kernel_case.threads.y > 1 ? kernel_case.threads.y : kernel_case.threads.x;
  for (std::uint32_t begin = 0; begin < count;) {
    const auto end = static_cast<std::uint32_t>(std::min<std::uint64_t>(count, begin + 1 + random.below(40)));
    kernel_case.kernel->cpu[static_cast<std::size_t>(isa)](
        {spans, kernel_case.params, kernel_case.threads, begin, end});
    begin = end;
  }
  return contents;
}

TEST(Slices, OfAnySizeGiveTheSameBytes) {
  Random random(1);
  const auto backend = make_cpu_backend({});
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.benchmark || source.large) {
      continue;
    }
    const KernelCase kernel_case = source.make();
    if (kernel_case.threads.x == 0 || kernel_case.threads.y == 0) {
      continue;
    }
    const CaseOutcome expected = run_case(*backend, kernel_case);
    for (const Isa isa : available_isas()) {
      ASSERT_TRUE(run_sliced(kernel_case, isa, random) == expected.contents)
          << source.kernel->name << ' ' << source.name << ' ' << to_string(isa);
    }
  }
}

TEST(CpuBackend, ManyShortDispatchesInARow) {
  const auto backend = make_cpu_backend({.threads = 4, .isa = std::nullopt});
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.benchmark && source.kernel->name == "gdt_merge") {
      const KernelCase kernel_case = source.make();
      const CaseOutcome expected = run_case(*make_cpu_backend({}), kernel_case);
      for (int i = 0; i < 200; ++i) {
        ASSERT_TRUE(run_case(*backend, kernel_case).contents == expected.contents);
      }
    }
  }
}

}  // namespace
}  // namespace gdtslam::test
