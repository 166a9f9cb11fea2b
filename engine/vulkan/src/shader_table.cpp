// Collects the rows of forms/*.cpp, in the order of the registry.
#include "shader_table.hpp"

#include <algorithm>
#include <vector>

#include "form_list.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostGroups = 65535;  // of one dimension, on every device

std::vector<ShaderForm> collect_forms() {
  std::vector<ShaderForm> all;
  for (const KernelInfo* kernel : kernel_registry()) {
    for (const FormFile& file : kFormFiles) {
      if (file.kernel == kernel->name) {
        const auto forms = file.forms();
        all.insert(all.end(), forms.begin(), forms.end());
      }
    }
  }
  return all;
}

}  // namespace

std::span<const ShaderForm> shader_forms() {
  static const std::vector<ShaderForm> all = collect_forms();
  return all;
}

std::span<const ShaderForm> forms_of(std::string_view kernel) {
  const auto all = shader_forms();
  const auto is_of = [kernel](const ShaderForm& form) { return form.kernel == kernel; };
  const auto begin = std::find_if(all.begin(), all.end(), is_of);
  const auto end = std::find_if_not(begin, all.end(), is_of);
  return {begin, end};
}

std::span<const ShaderModule> shader_modules() {
  static const std::vector<ShaderModule> all = [] {
    std::vector<ShaderModule> modules;
    for (const ShaderForm& form : shader_forms()) {
      modules.push_back({.kernel = form.kernel,
                         .name = form.name,
                         .spirv = form.spirv,
                         .local_size = form.local_size,
                         .uniform_binding = form.uniform_binding,
                         .texel_binding = form.texel_binding,
                         .push_constant_bytes = push_constant_bytes(form, find_kernel(form.kernel)->params_bytes),
                         .is_always_suitable = form.suits == nullptr});
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
