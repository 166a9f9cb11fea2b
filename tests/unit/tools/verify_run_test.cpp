// What `gdtslam verify` compares on a CPU, by the instruction sets and threads that are named.
#include "tools/gdtslam/verify/run.hpp"

#include <gtest/gtest.h>

#include <string>

namespace gdtslam {
namespace {

VerifyOptions of_the_cpu(const std::string& isa) {
  VerifyOptions options;
  options.device = {.device = "cpu", .isa = isa};
  options.filter = "seed_scatter";
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

}  // namespace
}  // namespace gdtslam
