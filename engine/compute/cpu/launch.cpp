#include "launch.hpp"

#include <cmath>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

std::string to_text(Extent extent) {
  return std::to_string(extent.x) + " x " + std::to_string(extent.y) + " x " + std::to_string(extent.z);
}

}  // namespace

void refuse_launch(std::string_view kernel, const std::string& message) {
  throw Error(ExitCode::kFailed, "kernel " + std::string(kernel) + ": " + message);
}

const IsaFunctions& functions_or_throw(Isa isa) {
  if (!is_compiled(isa)) {
    throw UnavailableError("this build has no kernels for the instruction set " + std::string(to_string(isa)));
  }
  count_kernel_call();
  return isa_functions(isa);
}

std::size_t grid_bytes(std::uint32_t width, std::uint32_t height, std::uint32_t stride, std::size_t cell_bytes) {
  if (width == 0 || height == 0) {
    return 0;
  }
  return (static_cast<std::size_t>(stride) * (height - 1) + width) * cell_bytes;
}

std::size_t field_bytes(const FieldLayout& layout, std::uint32_t width, std::uint32_t height) {
  if (!layout.has_strips()) return grid_bytes(width, height, layout.stride, sizeof(std::uint16_t));
  if (width == 0 || height == 0) return 0;
  // A strip's last row includes its 65th cell.
  return (layout.place((width - 1) / kStripWidth * kStripWidth, height - 1) + kStripWidth + 1) * sizeof(std::uint16_t);
}

void LaunchCheck::layout(const FieldLayout& layout, std::uint32_t width, std::uint32_t height,
                         std::uint32_t limit) const {
  const bool has_strips = layout.has_strips();
  grid(has_strips ? 0 : width, height, layout.stride, limit);
  require(layout.blank <= 65535, "the blank exceeds 16 bits");
  require(field_bytes(layout, width, height) / sizeof(std::uint16_t) <= std::uint64_t{1} << 32U,
          "a field of more than 2^32 cells");
  if (!has_strips) return;
  require(width <= limit, "a field in strips exceeds its limit of columns");
  require(layout.stride > kStripWidth, "the stride of a strip must be more than its 64 columns");
  require(layout.strip % 4 == 0 && layout.strip >= std::uint64_t{layout.stride} * height,
          "the strips overlap, or their distance is no multiple of 4");
}

void LaunchCheck::grid(std::uint32_t width, std::uint32_t height, std::uint32_t stride, std::uint32_t limit) const {
  if (width > limit || height > limit) {
    refuse_launch(kernel_, "a grid of " + std::to_string(width) + " x " + std::to_string(height) +
                               " cells exceeds its limit of " + std::to_string(limit) + " a side");
  }
  if (stride < width || stride % 4 != 0) {
    refuse_launch(kernel_, "stride " + std::to_string(stride) + " must be a multiple of 4 and at least the width, " +
                               std::to_string(width));
  }
}

void LaunchCheck::buffer(std::size_t binding, std::size_t bytes) const {
  const std::size_t has = shape_.buffer_bytes[binding];
  if (has < bytes) {
    refuse_launch(kernel_, "buffer " + std::to_string(binding) + " has " + std::to_string(has) + " bytes, needs " +
                               std::to_string(bytes));
  }
}

void LaunchCheck::extent(Extent wanted) const {
  if (!(shape_.threads == wanted)) {
    refuse_launch(kernel_, "extent " + to_text(shape_.threads) + ", expected " + to_text(wanted));
  }
}

void LaunchCheck::prior(const PriorParams& prior) const {
  const auto is_weight = [](float weight) { return std::isfinite(weight) && weight >= 0.0F; };
  require(std::isfinite(prior.mean_x) && std::isfinite(prior.mean_y) && std::isfinite(prior.mean_theta),
          "the prior's mean is not finite");
  require(is_weight(prior.weight_xy) && is_weight(prior.weight_theta),
          "a weight of the prior is negative or not finite");
  require(prior.limit >= 0.0F && prior.limit <= 1.0e9F, "the prior's limit is not within 0 to 1e9");
}

void LaunchCheck::require(bool condition, const char* message) const {
  if (!condition) {
    refuse_launch(kernel_, message);
  }
}

void check_launch(const KernelInfo& kernel, const LaunchShape& shape) {
  if (shape.buffer_bytes.size() != kernel.bindings.size()) {
    refuse_launch(kernel.name, std::to_string(shape.buffer_bytes.size()) + " buffers given, " +
                                   std::to_string(kernel.bindings.size()) + " bound");
  }
  if (shape.params.size() != kernel.params_bytes) {
    refuse_launch(kernel.name, std::to_string(shape.params.size()) + " bytes of parameters given, " +
                                   std::to_string(kernel.params_bytes) + " expected");
  }
  kernel.check(shape);
}

}  // namespace gdtslam
