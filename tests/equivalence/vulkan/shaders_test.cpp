// What is in the shaders, without a device: they fit their kernels, and no arithmetic of theirs can be contracted.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/vulkan/vulkan.hpp"
#include "support/spirv_reader.hpp"

namespace gdtslam::test {
namespace {

constexpr std::uint32_t kShaderCapability = 1;
constexpr std::uint32_t kSharedBytes = 16384;      // what every device has
constexpr std::uint32_t kPushConstantBytes = 128;  // likewise
constexpr std::uint32_t kGroupInvocations = 128;   // likewise
constexpr std::uint32_t kMostInvocations = 1024;   // what every device that we know has

/// Float operations whose result Vulkan fixes to the bit (IEEE rounding) when they are not contracted: negation,
/// addition, subtraction, multiplication. Division, for one, may be off by 2.5 ulp.
constexpr std::array<std::uint32_t, 5> kExactOperations{127, 129, 131, 133, 142};
/// Functions of GLSL.std.450 with one right result: round, floor, fract's kin and the integer ones; minima, maxima and
/// clamps of floats are only right without NaN, so a shader has to write them out. 1 Round, 3 Trunc, 4 FAbs, 5 SAbs,
/// 8 Floor, 9 Ceil, 38 UMin, 39 SMin, 41 UMax, 42 SMax, 44 UClamp, 45 SClamp, 73 FindILsb, 75 FindUMsb.
constexpr std::array<std::uint32_t, 13> kExactFunctions{3, 4, 5, 8, 9, 38, 39, 41, 42, 44, 45, 73, 75};

template <class List>
bool contains(const List& list, std::uint32_t value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

class Shaders : public testing::TestWithParam<std::size_t> {
 protected:
  const ShaderModule& shader = shader_modules()[GetParam()];
  const SpirvModule spirv = read_spirv(shader.spirv);
  const KernelInfo& kernel = *find_kernel(shader.kernel);
};

TEST_P(Shaders, BindWhatTheKernelBinds) {
  ASSERT_EQ(spirv.bindings.size(), kernel.bindings.size());
  for (std::uint32_t i = 0; i < kernel.bindings.size(); ++i) {
    ASSERT_TRUE(spirv.bindings.contains(i)) << "no binding " << i;
    const SpirvBinding& binding = spirv.bindings.at(i);
    EXPECT_FALSE(binding.is_uniform) << "binding " << i;
    EXPECT_EQ(binding.is_read_only, kernel.bindings[i] == Access::kRead) << "binding " << i;
  }
}

TEST_P(Shaders, TakeTheParametersAsTheyAre) {
  EXPECT_EQ(spirv.push_constant_bytes, shader.push_constant_bytes);
  EXPECT_FALSE(spirv.has_misaligned_push_constant) << "parameters are 4-byte scalars without gaps";
  EXPECT_LE(spirv.push_constant_bytes, kPushConstantBytes);
}

TEST_P(Shaders, LeaveTheSizeOfTheirGroupsOpen) {
  EXPECT_EQ(spirv.local_size_constants, (std::vector<std::uint32_t>{0, 1, 2}));
  for (const std::uint32_t constant : spirv.specialization_constants) {
    EXPECT_TRUE(constant <= 2 || constant == 10 || constant == 11) << "constant " << constant << " is never set";
  }
  const std::uint32_t invocations = shader.local_size[0] * shader.local_size[1] * shader.local_size[2];
  EXPECT_GT(invocations, 0U);
  EXPECT_LE(invocations, shader.is_always_suitable ? kGroupInvocations : kMostInvocations);
}

TEST_P(Shaders, AskForNothingThatADeviceMayLack) {
  EXPECT_EQ(spirv.capabilities, std::set<std::uint32_t>{kShaderCapability});
  EXPECT_TRUE(spirv.extensions.empty()) << *spirv.extensions.begin();
  EXPECT_LE(spirv.shared_bytes, kSharedBytes);
}

TEST_P(Shaders, ComputeTheSameBitsOnEveryDevice) {
  EXPECT_TRUE(spirv.contractible.empty())
      << spirv.contractible.size() << " without NoContraction, first " << spirv.contractible.front();
  for (const std::uint32_t operation : spirv.float_operations) {
    EXPECT_TRUE(contains(kExactOperations, operation)) << "opcode " << operation;
  }
  for (const std::uint32_t function : spirv.library_functions) {
    EXPECT_TRUE(contains(kExactFunctions, function)) << "GLSL.std.450 function " << function;
  }
}

std::vector<std::size_t> all_shaders() {
  std::vector<std::size_t> list(shader_modules().size());
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = i;
  return list;
}

INSTANTIATE_TEST_SUITE_P(All, Shaders, testing::ValuesIn(all_shaders()), [](const auto& index) {
  return std::to_string(index.param) + "_" + std::string(shader_modules()[index.param].kernel);
});

TEST(ShaderTable, HasAVariantForEveryKernelWhoseLastAlwaysSuits) {
  for (const KernelInfo* kernel : kernel_registry()) {
    const ShaderModule* last = nullptr;
    for (const ShaderModule& shader : shader_modules()) {
      if (shader.kernel == kernel->name) last = &shader;
    }
    ASSERT_NE(last, nullptr) << kernel->name << " has no shader";
    EXPECT_TRUE(last->is_always_suitable) << kernel->name << ": its last variant need not suit";
  }
}

TEST(ShaderTable, HasNoShaderOfAKernelThatDoesNotExist) {
  for (const ShaderModule& shader : shader_modules()) EXPECT_NE(find_kernel(shader.kernel), nullptr) << shader.kernel;
}

TEST(SpirvReader, RefusesWhatIsNoModule) {
  const std::array<std::uint32_t, 6> cut{0x07230203, 0x00010500, 0, 10, 0, 0x00050011};
  EXPECT_THROW(read_spirv({}), std::runtime_error);
  EXPECT_THROW(read_spirv(std::span(cut).subspan(1)), std::runtime_error);
  EXPECT_THROW(read_spirv(cut), std::runtime_error);
}

/// A deliberate fault: without its decorations a shader must be found out.
TEST(SpirvReader, SeesArithmeticThatMayBeContracted) {
  constexpr std::uint32_t kDecorateNoContraction = 42;
  std::size_t shaders_with_floats = 0;
  for (const ShaderModule& shader : shader_modules()) {
    std::vector<std::uint32_t> words(shader.spirv.begin(), shader.spirv.end());
    const std::size_t operations = read_spirv(words).float_operations.size();
    for (std::size_t at = 5; at < words.size(); at += words[at] >> 16U) {
      if ((words[at] & 0xFFFFU) == 71 && words[at + 2] == kDecorateNoContraction) words[at + 2] = 0;  // relaxed
    }
    const bool is_found = !read_spirv(words).contractible.empty();
    EXPECT_EQ(is_found, operations > 0) << shader.kernel;
    shaders_with_floats += operations > 0 ? 1 : 0;
  }
  EXPECT_GT(shaders_with_floats, 0U);
}

}  // namespace
}  // namespace gdtslam::test
