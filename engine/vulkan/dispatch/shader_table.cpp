#include "shader_table.hpp"

#include <algorithm>
#include <vector>

namespace gdtslam {

std::span<const ShaderVariant> variants_of(std::string_view kernel) {
  const auto all = shader_variants();
  const auto is_of = [kernel](const ShaderVariant& variant) { return variant.shader.kernel() == kernel; };
  const auto begin = std::find_if(all.begin(), all.end(), is_of);
  const auto end = std::find_if_not(begin, all.end(), is_of);
  return {begin, end};
}

std::span<const ShaderModule> shader_modules() {
  static const std::vector<ShaderModule> all = [] {
    std::vector<ShaderModule> modules;
    for (const ShaderVariant& variant : shader_variants()) {
      const std::string_view kernel = variant.shader.kernel();
      modules.push_back({.kernel = kernel,
                         .name = variant.shader.name,
                         .spirv = variant.shader.spirv,
                         .local_size = variant.local_size,
                         .uniform_binding = variant.uniform_binding,
                         .texel_binding = variant.texel_binding,
                         .push_constant_bytes = push_constant_bytes(variant, find_kernel(kernel)->params_bytes),
                         .is_always_suitable = variant.suits == nullptr});
    }
    return modules;
  }();
  return all;
}

}  // namespace gdtslam
