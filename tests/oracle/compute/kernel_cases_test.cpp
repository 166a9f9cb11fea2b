// Every case of the list, in every instruction set of this processor, against the brute-force oracles: all bytes must
// be equal, the padding of the rows included, and guards and inputs untouched.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "engine/compute/cases/kernel_cases.hpp"
#include "support/brute_force.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

std::string describe(const CaseDifference& difference) {
  return std::to_string(difference.values) + " values differ, by up to " + std::to_string(difference.largest) +
         ", first at (" + std::to_string(difference.x) + ", " + std::to_string(difference.y) + ") of buffer " +
         std::to_string(difference.binding);
}

/// A backend under test and what to call it.
struct Device {
  std::string name;
  std::unique_ptr<Backend> backend;
};

std::vector<Device> devices() {
  std::vector<Device> list;
  for (const Isa isa : available_isas()) {
    list.push_back({std::string(to_string(isa)), make_cpu_backend({.threads = 1, .isa = isa})});
  }
  list.push_back({"three threads", make_cpu_backend({.threads = 3, .isa = std::nullopt})});
  return list;
}

void expect_equal(const KernelCase& kernel_case, const CaseOutcome& expected, const CaseOutcome& found,
                  const std::string& where) {
  const auto apart = difference(kernel_case, expected, found);
  EXPECT_FALSE(apart) << where << ": " << describe(*apart);
  EXPECT_TRUE(found.contents == expected.contents) << where << ": padding was written";
  EXPECT_TRUE(found.guards_intact) << where << ": something was written behind a buffer";
  EXPECT_TRUE(found.inputs_intact) << where << ": an input was written";
}

class KernelCases : public testing::TestWithParam<std::string> {};

TEST_P(KernelCases, MatchTheOracleInEveryByte) {
  const std::vector<Device> all = devices();
  std::size_t tried = 0;
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.kernel->name != GetParam() || source.large) {
      continue;
    }
    ++tried;
    const KernelCase kernel_case = source.make();
    const CaseOutcome expected = brute_outcome(kernel_case);
    for (const Device& device : all) {
      expect_equal(kernel_case, expected, run_case(*device.backend, kernel_case), source.name + ", " + device.name);
    }
    if (HasFailure()) {
      return;
    }
  }
  EXPECT_GT(tried, 0U) << "the list has no case for " << GetParam();
}

std::vector<std::string> kernel_names() {
  std::vector<std::string> names;
  for (const KernelInfo* kernel : kernel_registry()) {
    names.emplace_back(kernel->name);
  }
  return names;
}

TEST(RandomKernelCases, MatchTheOracleInEveryByte) {
  const std::vector<Device> all = devices();
  for (const KernelCaseSource& source : random_kernel_cases(20240229, 1500)) {
    const KernelCase kernel_case = source.make();
    const CaseOutcome expected = brute_outcome(kernel_case);
    for (const Device& device : all) {
      expect_equal(kernel_case, expected, run_case(*device.backend, kernel_case),
                   std::string(source.kernel->name) + ", " + source.name + ", " + device.name);
    }
    if (HasFailure()) {
      return;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, KernelCases, testing::ValuesIn(kernel_names()),
                         [](const auto& kernel) { return kernel.param; });

}  // namespace
}  // namespace gdtslam::test
