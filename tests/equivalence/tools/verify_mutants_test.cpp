// What `gdtslam verify` does must find a shader that is wrong in one literal, in every shader of the build.
// GDTSLAM_ALL_MUTANTS=1 tries every literal of every shader, about 1,500 and a quarter of an hour, else some of each.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "support/spirv_mutants.hpp"
#include "support/vulkan_device.hpp"
#include "tools/gdtslam/verify/kernels.hpp"

namespace gdtslam {
namespace {

using test::ConstantUse;

/// The cases of a kernel that a quick verification runs, built once, the small ones first.
const std::vector<KernelCase>& cases_of(std::string_view kernel) {
  static std::map<std::string, std::vector<KernelCase>, std::less<>> all;
  const auto found = all.find(kernel);
  if (found != all.end()) return found->second;
  std::vector<KernelCase>& list = all[std::string(kernel)];
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.kernel->name == kernel && !source.large) list.push_back(source.make());
  }
  return list;
}

/// How a verification of one kernel with a changed shader ends.
enum class Outcome : std::uint8_t { kFound, kNotFound, kNotUsed };

Outcome verify_with(const ShaderModule& shader, const std::vector<std::uint32_t>& words) {
  bool used = false;
  VulkanOptions options;
  options.wait_limit_s = 10.0;
  options.edit_shader = [&](std::string_view name, std::vector<std::uint32_t>& spirv) {
    if (name != shader.kernel) return;
    used = true;
    spirv = words;
  };
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  try {
    const std::unique_ptr<VulkanBackend> device = test::test_backend(options);
    KernelVerifier verifier(*cpu, *device, Proof::kDeviceDidIt);
    for (const KernelCase& kernel_case : cases_of(shader.kernel)) {
      verifier.check(kernel_case);
      if (verifier.verdicts().front().differences() > 0) return Outcome::kFound;
    }
  } catch (const DeviceError&) {
    return Outcome::kFound;  // the command ends with it, and with exit 1
  }
  return used ? Outcome::kNotFound : Outcome::kNotUsed;
}

/// Uses of a literal that a shader may have changed without any value changing, and why; the shader is the beginning of
/// its name. `most` of them may stay unseen. What only costs time is here too: a block more that holds nothing, a load
/// whose value is thrown away.
struct Equivalent {
  std::string_view shader;
  std::string_view what;
  std::size_t most = 1;
  std::string_view why;
};
constexpr Equivalent kEquivalents[] = {
    {"", "FOrdGreaterThan -1.07374182e+09", 1, "any limit between the map and 2^31 leaves the point at the same edge"},
    {"", "Select -1.07374182e+09", 1, "the same"},
    {"", "FOrdLessThan 1.07374182e+09", 1, "the same"},
    {"", "Select 1.07374182e+09", 1, "the same"},
    {"", "SGreaterThan 16", 1, "twice a number of bits is even, so more than 16 is more than 17"},
    {"", "FMul 6.07710063e-11", 1, "the last part of a quarter turn: below 1e-8 cells at every angle of a pose"},
    {"", "FSub 1", 1, "what the head of a cosine has too much its tail has too little"},
    {"field_grow", "Store 0", 1, "what is read for want of another is thrown away"},
    {"gdt_merge", "INotEqual 64", 1, "in rows the cell that is repeated is the cell itself"},
    {"gdt_merge", "UGreaterThan 0", 1, "no strip begins with the second quad"},
    {"gdt_stamp", "INotEqual 64", 1, "in rows the cell that is repeated is the cell itself"},
    {"gdt_stamp", "Store 0", 2, "what is read for want of another is thrown away"},
    {"gdt_stamp", "Select 65535", 1, "any value from the cap on changes nothing"},
    {"gdt_stamp", "UDiv 1024", 1, "a launch has no invocation beyond the tiles' 1,024 each"},
    {"gdt_stamp", "IAdd 1", 1, "an even number and one more, rounded down to fours, are the same"},
    {"gdt_stamp", "IAdd 64", 1, "the same"},
    {"gdt_stamp", "IAdd 3", 1, "the same"},
    {"ndt_cost", "FOrdLessThan 255", 1, "the integer is clamped once more"},
    {"ndt_cost", "Select 255", 1, "the same"},
    {"ndt_cost", "IEqual 0", 1, "another invocation writes what this one would"},
    {"point_to_line", "FOrdGreaterThan 1.00000005e-18", 1, "so near to the robot Y is 0, or too small for another bin"},
    {"point_to_line", "Select 1", 1, "the same"},
    {"point_to_line", "Select 0", 1, "the first point in bin 1 or after it is that of bin 0"},
    {"point_to_line", "FOrdGreaterThan 0", 1, "a direction in bin 0 stays there"},
    {"point_to_line", "ULessThan 11", 4, "a twelfth sum is not read"},
    {"pose_bounds", "Select 0", 1, "groups beyond the launch look at some tile and keep nothing"},
    {"pose_bounds", "Store 0", 1, "groups beyond the launch keep nothing"},
    {"pose_bounds", "IEqual 0", 1, "another invocation writes what this one would"},
    {"pose_cost", "Select 0", 1, "groups beyond the batch cost some candidate and keep nothing"},
    {"pose_cost", "Store 0", 1, "groups beyond the batch keep nothing"},
    {"pose_cost", "IEqual 0", 1, "another invocation writes what this one would"},
    {"pose_descent", "FOrdGreaterThan 1000", 1, "the width is done with a damping of 1,024 and with one of 4,096"},
    {"pose_descent", "FOrdLessThan 0.25", 1, "the damping is 0.0001, or at least 1"},
    {"pose_descent", "IEqual 0", 1, "another invocation writes what this one would"},
    {"pose_descent", "ISub 1", 2, "the two outermost columns and rows hold the cap"},
    {"pose_descent", "Select 0", 3,
     "beyond the edge every cell that is read holds the cap, so its fraction does not matter"},
    {"pose_descent", "Store 1", 1, "the gate is set once more before it is read"},
    {"sweep_points", "BitwiseAnd 2139095040", 1, "no operation makes a NaN whose lowest bit is set"},
    {"sweep_points", "ULessThan 2139095040", 1, "an infinite range gives a point that is not finite, so none"},
};

/// How many uses of that text may stay unseen in a shader.
std::size_t allowed(std::string_view shader, std::string_view what) {
  std::size_t most = 0;
  for (const Equivalent& e : kEquivalents) {
    if (shader.starts_with(e.shader) && e.what == what) most += e.most;
  }
  return most;
}

bool wants_all() {
  const char* const value = std::getenv("GDTSLAM_ALL_MUTANTS");
  return value != nullptr && std::string_view(value) == "1";
}

/// Some of the uses, spread over the shader, or all of them.
std::vector<ConstantUse> tried(const ShaderModule& shader) {
  constexpr std::size_t kTried = 4;
  std::vector<ConstantUse> uses = test::constant_uses(shader.spirv);
  if (wants_all() || uses.size() <= kTried) return uses;
  std::vector<ConstantUse> some;
  for (std::size_t k = 0; k < kTried; ++k) some.push_back(uses[(2 * k + 1) * uses.size() / (2 * kTried)]);
  return some;
}

class VerifyMutants : public testing::TestWithParam<std::string> {};

TEST_P(VerifyMutants, AreFound) {
  GDTSLAM_NEEDS_VULKAN();
  const auto all = shader_modules();
  const auto shader =
      std::find_if(all.begin(), all.end(), [](const ShaderModule& m) { return m.kernel == GetParam(); });
  ASSERT_NE(shader, all.end());
  const std::vector<ConstantUse> uses = tried(*shader);
  ASSERT_FALSE(uses.empty()) << "no literal to change";
  std::map<std::string, std::vector<std::size_t>> unseen;  // by text, the words where they are
  for (const ConstantUse& use : uses) {
    const Outcome outcome = verify_with(*shader, test::mutant(shader->spirv, use));
    ASSERT_NE(outcome, Outcome::kNotUsed) << "no case uses the shader";
    if (outcome == Outcome::kNotFound) unseen[use.what].push_back(use.at);
  }
  for (const auto& [what, words] : unseen) {
    EXPECT_LE(words.size(), allowed(GetParam(), what))
        << what << " at word " << testing::PrintToString(words) << ": changed, and nothing found it";
  }
}

// The same way of looking finds nothing where nothing was changed.
TEST_P(VerifyMutants, NoneMeansNoDifference) {
  GDTSLAM_NEEDS_VULKAN();
  const auto all = shader_modules();
  const auto shader =
      std::find_if(all.begin(), all.end(), [](const ShaderModule& m) { return m.kernel == GetParam(); });
  ASSERT_NE(shader, all.end());
  EXPECT_EQ(verify_with(*shader, {shader->spirv.begin(), shader->spirv.end()}), Outcome::kNotFound);
}

std::vector<std::string> shader_names() {
  std::vector<std::string> names;
  for (const ShaderModule& shader : shader_modules()) names.emplace_back(shader.kernel);
  std::sort(names.begin(), names.end());  // a shader may serve several variants
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, VerifyMutants, testing::ValuesIn(shader_names()),
                         [](const auto& shader) { return shader.param; });

}  // namespace
}  // namespace gdtslam
