// The core of `gdtslam verify` must find out a backend that computes wrongly, and one that has the CPU do its work.
#include "tools/gdtslam/verify/kernels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "support/secret_cpu.hpp"

namespace gdtslam {
namespace {

using test::SecretCpu;
using test::Trick;
using testing::HasSubstr;

/// Every case that is small, of every kernel, on the CPU against the backend.
std::vector<KernelVerdict> verdicts_on(Backend& backend, Proof proof) {
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  KernelVerifier verifier(*cpu, backend, proof);
  for (const KernelCaseSource& source : kernel_cases()) {
    if (!source.benchmark && !source.large) verifier.check(source.make());
  }
  verifier.finish();
  return verifier.verdicts();
}

std::uint64_t differences_in(const std::vector<KernelVerdict>& verdicts) {
  std::uint64_t sum = 0;
  for (const KernelVerdict& verdict : verdicts) sum += verdict.differences();
  return sum;
}

TEST(KernelVerifier, FindsNothingBetweenEqualBackends) {
  SecretCpu backend(Trick::kNone);
  const std::vector<KernelVerdict> verdicts = verdicts_on(backend, Proof::kNone);
  EXPECT_EQ(verdicts.size(), kernel_registry().size());
  for (const KernelVerdict& verdict : verdicts) {
    EXPECT_GT(verdict.cases, 0U) << verdict.kernel;
    EXPECT_GT(verdict.values, 0U) << verdict.kernel;
    EXPECT_EQ(verdict.differences(), 0U) << verdict.kernel << ": " << verdict.first;
    EXPECT_EQ(verdict.first, "");
  }
}

// With the proof every kernel of the registry must be found out, not only one of them.
void expect_every_kernel_found(Trick trick, const std::string& first) {
  SecretCpu backend(trick);
  const std::vector<KernelVerdict> verdicts = verdicts_on(backend, Proof::kDeviceDidIt);
  EXPECT_EQ(verdicts.size(), kernel_registry().size());
  for (const KernelVerdict& verdict : verdicts) {
    EXPECT_GT(verdict.faults, 0U) << verdict.kernel;
    EXPECT_THAT(verdict.first, HasSubstr(first)) << verdict.kernel;
  }
}

TEST(KernelVerifier, FindsOutABackendThatSecretlyRunsTheCpuCode) {
  expect_every_kernel_found(Trick::kNone, "a CPU kernel ran while the device should have worked");
}

TEST(KernelVerifier, FindsOutABackendThatRunsTheCpuCodeOfTheRegistry) {
  expect_every_kernel_found(Trick::kOwnRegistry, "a CPU kernel ran while the device should have worked");
}

/// The verdict on one kernel of one case that shows something.
KernelVerdict verdict_on_one(Trick trick, Proof proof) {
  SecretCpu backend(trick);
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  KernelVerifier verifier(*cpu, backend, proof);
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.kernel->name != "distance_field") continue;
    const KernelCase kernel_case = source.make();
    const ValueLayout& field = kernel_case.buffers.back().layout;
    // The spoilt byte must lie in a value, not in the padding of the rows.
    if (field.width < 2 || field.height < 2 || field.width != field.stride || source.benchmark) continue;
    verifier.check(kernel_case);
    break;
  }
  verifier.finish();
  EXPECT_EQ(verifier.verdicts().size(), 1U);
  return verifier.verdicts().front();
}

// A CPU that a backend calls directly counts as well; that the functions it was given were called shows apart from
// that.
TEST(KernelVerifier, DecoysShowWhoCallsTheCpuFunctions) {
  const KernelVerdict honest_registry = verdict_on_one(Trick::kOwnRegistry, Proof::kDeviceDidIt);
  const KernelVerdict given = verdict_on_one(Trick::kNone, Proof::kDeviceDidIt);
  EXPECT_EQ(honest_registry.different, 0U) << "the registry's functions give the right values even for a decoy";
  EXPECT_GT(given.different, 0U) << "a decoy that is called must leave wrong values";
  EXPECT_GT(given.faults, 0U);
  EXPECT_GT(honest_registry.faults, 0U);
}

TEST(KernelVerifier, FindsWhatADeviceMustNotShow) {
  const std::uint64_t usual = verdict_on_one(Trick::kNone, Proof::kDeviceDidIt).faults;
  EXPECT_EQ(verdict_on_one(Trick::kShowsMemory, Proof::kDeviceDidIt).faults, usual + 1);
  EXPECT_EQ(verdict_on_one(Trick::kCountsNothing, Proof::kDeviceDidIt).faults, usual + 2) << "the case and its decoy";
}

TEST(KernelVerifier, FindsAWrongValueWithItsPlace) {
  const KernelVerdict verdict = verdict_on_one(Trick::kWrongValue, Proof::kNone);
  EXPECT_EQ(verdict.different, 1U);
  EXPECT_EQ(verdict.largest, 256U) << "the lowest bit of the upper byte";
  EXPECT_EQ(verdict.faults, 0U);
  EXPECT_THAT(verdict.first, testing::MatchesRegex("'.*': buffer 2 at \\([0-9]+, [0-9]+\\)"));
}

TEST(KernelVerifier, FindsWritesBehindABufferAndIntoAnInput) {
  EXPECT_THAT(verdict_on_one(Trick::kWritesGuard, Proof::kNone).first, HasSubstr("written behind a buffer"));
  EXPECT_EQ(verdict_on_one(Trick::kWritesGuard, Proof::kNone).faults, 1U);
  EXPECT_GT(verdict_on_one(Trick::kWritesInput, Proof::kNone).faults, 0U);
}

TEST(KernelVerifier, FindsASingleWrongCaseAmongAll) {
  SecretCpu backend(Trick::kWritesGuard, 400);
  EXPECT_GT(differences_in(verdicts_on(backend, Proof::kNone)), 0U);
}

TEST(KernelVerifier, AKernelThatNoCaseProvesIsAFault) {
  SecretCpu backend(Trick::kNone);
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  KernelVerifier verifier(*cpu, backend, Proof::kDeviceDidIt);
  for (const KernelCaseSource& source : kernel_cases()) {
    const KernelCase kernel_case = source.make();
    if (kernel_case.threads.x != 0 && kernel_case.threads.y != 0) continue;  // keeps a case that does nothing
    verifier.check(kernel_case);
    break;
  }
  ASSERT_EQ(verifier.verdicts().size(), 1U);
  const std::uint64_t before = verifier.verdicts().front().faults;
  verifier.finish();
  EXPECT_EQ(verifier.verdicts().front().faults, before + 1);
}

}  // namespace
}  // namespace gdtslam
