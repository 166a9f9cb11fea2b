// What of a verification is kept as the device's: by hand-made reports, each with what it must leave behind.
#include "tools/gdtslam/verify/run.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gdtslam {
namespace {

TargetReport target(std::uint64_t cases, std::uint64_t different, std::size_t logs) {
  TargetReport report;
  report.is_vulkan = true;
  KernelVerdict kernel;
  kernel.kernel = "smallest_values";
  kernel.cases = cases;
  kernel.different = different;
  report.kernels = {kernel};
  report.logs.resize(logs);
  return report;
}

VerifyReport report_of(std::vector<TargetReport> targets) {
  VerifyReport report;
  report.targets = std::move(targets);
  return report;
}

std::optional<VerifyRecord> kept(const VerifyReport& report, const std::string& filter = "") {
  VerifyOptions options;
  options.filter = filter;
  return record_of(report, options, "2026-01-02T03:04:05Z");
}

TEST(RecordOf, TheWhole) {
  const std::optional<VerifyRecord> record = kept(report_of({target(10, 0, 2)}));
  ASSERT_TRUE(record);
  EXPECT_TRUE(record->passed());
  EXPECT_EQ(record->date, "2026-01-02T03:04:05Z");
  EXPECT_EQ(record->cases, 10U);
  EXPECT_EQ(record->logs, 2U);
}

TEST(RecordOf, APartCountsOnlyWithADifference) {
  EXPECT_EQ(kept(report_of({target(10, 0, 0)}), "smallest_values"), std::nullopt);
  const std::optional<VerifyRecord> record = kept(report_of({target(10, 3, 0)}), "smallest_values");
  ASSERT_TRUE(record);
  EXPECT_EQ(record->differences, 3U);
}

TEST(RecordOf, ADeviceThatFailedIsRemembered) {
  TargetReport failed;
  failed.is_vulkan = true;
  failed.failure = "vulkan:0: vkQueueSubmit gave ErrorDeviceLost";
  for (const char* filter : {"", "smallest_values"}) {
    const std::optional<VerifyRecord> record = kept(report_of({failed}), filter);
    ASSERT_TRUE(record);
    EXPECT_FALSE(record->passed());
    EXPECT_EQ(record->failure, failed.failure);
  }
}

TEST(RecordOf, WhatWasEndedByAnotherErrorIsNoWhole) {
  TargetReport ended = target(10, 0, 1);
  ended.error = "drive.log: holds no laser scan to map";
  EXPECT_EQ(kept(report_of({ended})), std::nullopt);
  ended.kernels.front().different = 3;
  const std::optional<VerifyRecord> record = kept(report_of({ended}));
  ASSERT_TRUE(record);
  EXPECT_EQ(record->differences, 3U);
}

VerifyOptions of_the_cpu(const std::string& isa) {
  VerifyOptions options;
  options.device = {.device = "cpu", .isa = isa};
  options.filter = "smallest_values";
  options.quiet = true;
  return options;
}

TEST(RunVerify, AnInstructionSetThatIsNamedIsTheOnlyOne) {
  EXPECT_THROW(run_verify(of_the_cpu("avx1024")), UsageError);
  for (const Isa isa : {Isa::kBaseline, Isa::kAvx2, Isa::kAvx512}) {
    const std::string name(to_string(isa));
    if (!isa_available(isa)) {
      EXPECT_THROW(run_verify(of_the_cpu(name)), UnavailableError) << name;
      continue;
    }
    const VerifyReport report = run_verify(of_the_cpu(name));
    EXPECT_TRUE(report.passed()) << name;
    EXPECT_EQ(report.targets.size(), isa == Isa::kBaseline ? 1U : 2U) << name;
    for (const TargetReport& part : report.targets) EXPECT_EQ(part.device.driver, name) << part.name;
    EXPECT_EQ(report.targets.back().device.threads, 3U) << name;
  }
}

TEST(RunVerify, ThreadsThatAreNamedAreTaken) {
  VerifyOptions options = of_the_cpu("");
  options.device.threads = 5;
  options.device.are_threads_given = true;
  const VerifyReport report = run_verify(options);
  EXPECT_EQ(report.targets.back().name, "cpu, 5 threads");
  EXPECT_EQ(report.targets.back().device.threads, 5U);
}

TEST(RunVerify, ALogThatIsNotThereIsToldBeforeTheKernels) {
  VerifyOptions options = of_the_cpu("baseline");
  options.filter = "";
  options.logs = {"/nowhere/drive.log"};
  EXPECT_THROW(run_verify(options), FileError);
}

TEST(RecordOf, TheCpuIsNoDevice) {
  TargetReport cpu = target(10, 3, 2);
  cpu.is_vulkan = false;
  EXPECT_EQ(kept(report_of({cpu})), std::nullopt);
}

}  // namespace
}  // namespace gdtslam
