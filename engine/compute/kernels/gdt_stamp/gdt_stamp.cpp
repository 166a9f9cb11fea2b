#include "gdt_stamp.hpp"

#include <cassert>

#include "engine/compute/cpu/launch.hpp"
#include "engine/compute/kernels/distance_field/distance_field.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostWords = 1U << 28U;
constexpr std::uint32_t kMostStampsOfATile = 1U << 17U;

}  // namespace

std::vector<std::uint16_t> stamp_disc(std::uint32_t radius) {
  assert(radius >= 1 && radius <= 255);
  const std::vector<std::uint16_t> table = distance_table(radius);
  const std::uint32_t stride = disc_stride(radius);
  std::vector<std::uint16_t> disc(std::size_t{stride} * (radius + 1), field_cap(radius));
  for (std::uint32_t dy = 0; dy <= radius; ++dy) {
    for (std::uint32_t dx = 0; dx * dx + dy * dy < radius * radius; ++dx) {
      const std::size_t centre = std::size_t{dy} * stride + radius + kDiscMargin;
      disc[centre - dx] = disc[centre + dx] = table[dx * dx + dy * dy];
    }
  }
  return disc;
}

const KernelInfo& GdtStamp::info() {
  static const KernelInfo row = kernel_info<GdtStamp>(
      {"gdt_stamp", "cell", "paper equations (1) and (9) to (11)"}, kCall<&IsaFunctions::gdt_stamp>,
      [](const Params& params, Extent) -> std::uint64_t {
        return std::uint64_t{params.tile_count} * kStampTile * kStampTile;
      },
      [](const Params& params, const LaunchCheck& check) {
        check.require(params.radius >= 1 && params.radius <= 255, "the radius must be 1 to 255 cells");
        check.require(params.stride % 4 == 0, "the field's stride must be a multiple of 4");
        check.require(params.strip % 4 == 0 && params.blank <= 65535,
                      "the distance of strips must be a multiple of 4, the blank of 16 bits");
        check.require(params.strip == kStripWidth || params.stride > kStripWidth,
                      "the stride of a strip must be more than its 64 columns");
        check.require(params.lift <= params.threshold, "the lift exceeds the threshold");
        check.require(params.cap == field_cap(params.radius), "the cap is not that of the radius");
        check.require(params.rule == MergeRule::kWorking || params.rule == MergeRule::kLiteral, "unknown rule");
        check.require(params.words <= kMostWords, "a list of more than 2^28 words");
        check.require(params.words % kStampGroup == 0 && params.words / 4 >= params.tile_count,
                      "the list does not hold the tiles and groups of obstacles");
        check.require(params.most_obstacles <= kMostStampsOfATile, "more than 2^17 obstacles of a tile");
        check.buffer(1, std::size_t{params.words} * 4);
        check.buffer(2, std::size_t{disc_stride(params.radius)} * (params.radius + 1) * 2);
        check.extent({params.tile_count, 1, 1});
      });
  return row;
}

}  // namespace gdtslam
