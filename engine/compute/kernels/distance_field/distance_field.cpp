#include "distance_field.hpp"

#include "engine/compute/cpu/launch.hpp"

namespace gdtslam {
namespace {

/// floor(sqrt(n)), bit by bit.
std::uint32_t integer_sqrt(std::uint64_t n) {
  std::uint64_t root = 0;
  for (std::uint64_t bit = std::uint64_t{1} << 31U; bit != 0; bit >>= 1U) {
    const std::uint64_t trial = root | bit;
    if (trial * trial <= n) {
      root = trial;
    }
  }
  return static_cast<std::uint32_t>(root);
}

}  // namespace

std::vector<std::uint16_t> distance_table(std::uint32_t radius) {
  std::vector<std::uint16_t> table(std::size_t{radius} * radius + 1);
  for (std::size_t sq = 0; sq < table.size(); ++sq) {
    // round(256 sqrt(sq)) = floor((floor(sqrt(4 * 65536 sq)) + 1) / 2)
    table[sq] = static_cast<std::uint16_t>((integer_sqrt(std::uint64_t{4} * kFieldOne * kFieldOne * sq) + 1) / 2);
  }
  return table;
}

const KernelInfo& DistanceField::info() {
  static const KernelInfo row = kernel_info<DistanceField>(
      {"distance_field", "cell", "square root of paper equation (1) by an integer table"},
      kCall<&IsaFunctions::distance_field>, kCells, [](const Params& params, const LaunchCheck& check) {
        check.grid(params.width, params.height, params.stride, kNoLimit);
        check.require(params.table_size > 0, "the table is empty");
        check.buffer(0, grid_bytes(params.width, params.height, params.stride, 2));
        check.buffer(1, std::size_t{params.table_size} * 2);
        check.buffer(2, grid_bytes(params.width, params.height, params.stride, 2));
        check.extent({params.width, params.height, 1});
      });
  return row;
}

}  // namespace gdtslam
