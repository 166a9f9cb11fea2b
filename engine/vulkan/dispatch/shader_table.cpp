// Collects the rows of variants/*.cpp, in the order of the registry.
#include "shader_table.hpp"

#include <algorithm>
#include <vector>

#include "variant_list.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostGroups = 65535;  // of one dimension, on every device

std::vector<ShaderVariant> collect_variants() {
  std::vector<ShaderVariant> all;
  for (const KernelInfo* kernel : kernel_registry()) {
    for (const VariantFile& file : kVariantFiles) {
      if (file.kernel == kernel->name) {
        const auto variants = file.variants();
        all.insert(all.end(), variants.begin(), variants.end());
      }
    }
  }
  return all;
}

}  // namespace

std::span<const ShaderVariant> shader_variants() {
  static const std::vector<ShaderVariant> all = collect_variants();
  return all;
}

std::span<const ShaderVariant> variants_of(std::string_view kernel) {
  const auto all = shader_variants();
  const auto is_of = [kernel](const ShaderVariant& variant) { return variant.kernel == kernel; };
  const auto begin = std::find_if(all.begin(), all.end(), is_of);
  const auto end = std::find_if_not(begin, all.end(), is_of);
  return {begin, end};
}

std::span<const ShaderModule> shader_modules() {
  static const std::vector<ShaderModule> all = [] {
    std::vector<ShaderModule> modules;
    for (const ShaderVariant& variant : shader_variants()) {
      modules.push_back({.kernel = variant.kernel,
                         .name = variant.name,
                         .spirv = variant.spirv,
                         .local_size = variant.local_size,
                         .uniform_binding = variant.uniform_binding,
                         .texel_binding = variant.texel_binding,
                         .push_constant_bytes = push_constant_bytes(variant, find_kernel(variant.kernel)->params_bytes),
                         .is_always_suitable = variant.suits == nullptr});
    }
    return modules;
  }();
  return all;
}

GroupCount folded(std::uint64_t count) {
  if (count <= kMostGroups) {
    return {static_cast<std::uint32_t>(count), 1, 1};
  }
  return {kMostGroups, static_cast<std::uint32_t>((count + kMostGroups - 1) / kMostGroups), 1};
}

}  // namespace gdtslam
