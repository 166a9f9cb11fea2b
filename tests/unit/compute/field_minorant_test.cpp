// Minorants of a field by the words of pose_bounds.hpp: slopes from three rows and three columns, the constant below
// every cell of the square.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/core/random.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

constexpr std::int32_t kFieldWide = 21;
constexpr std::int32_t kFieldHigh = 17;
constexpr std::int32_t kFieldStride = 24;
constexpr auto kAround = static_cast<std::int32_t>(FieldMinorant::kMargin);

struct MinorantField {
  std::vector<std::uint16_t> cells;
  std::int32_t cap = 0;

  /// Beyond the edge lies the cap, and no cell counts as more.
  [[nodiscard]] std::int32_t at(std::int32_t x, std::int32_t y) const {
    if (x < 0 || y < 0 || x >= kFieldWide || y >= kFieldHigh) return cap;
    return std::min<std::int32_t>(cap, cells[static_cast<std::size_t>(y * kFieldStride + x)]);
  }
};

MinorantField drawn_field(std::int32_t cap, std::uint64_t seed) {
  Random random(seed);
  MinorantField field{.cells = std::vector<std::uint16_t>(static_cast<std::size_t>(kFieldStride * kFieldHigh)),
                      .cap = cap};
  for (std::uint16_t& cell : field.cells) {
    cell = static_cast<std::uint16_t>(random.below(static_cast<std::uint64_t>(cap) + 1));
  }
  return field;
}

struct MinorantWord {
  std::int32_t constant = 0;
  std::int32_t slope_x = 0;
  std::int32_t slope_y = 0;
};

MinorantWord word_by_definition(const MinorantField& field, std::int32_t x, std::int32_t y, std::int32_t reach,
                                std::int32_t unit) {
  std::int32_t rise_x = 0;
  std::int32_t rise_y = 0;
  for (const std::int32_t k : {-reach, 0, reach}) {
    rise_x += field.at(x + reach, y + k) - field.at(x - reach, y + k);
    rise_y += field.at(x + k, y + reach) - field.at(x + k, y - reach);
  }
  const auto slope_of = [reach](std::int32_t rise) {
    return std::clamp(rise / (6 * reach * FieldMinorant::kSlopeUnit), -127, 127);  // cut towards zero
  };
  MinorantWord word{.slope_x = slope_of(rise_x), .slope_y = slope_of(rise_y)};
  std::int32_t least = INT32_MAX;
  for (std::int32_t j = -reach; j <= reach; ++j) {
    for (std::int32_t i = -reach; i <= reach; ++i) {
      const std::int32_t slopes = FieldMinorant::kSlopeUnit * (word.slope_x * i + word.slope_y * j);
      least = std::min(least, field.at(x + i, y + j) - slopes);
    }
  }
  const std::div_t parts = std::div(least, unit);
  word.constant = parts.quot - (parts.rem < 0 ? 1 : 0);
  return word;
}

TEST(FieldMinorants, AreThoseOfTheirDefinition) {
  for (const Isa isa : available_isas()) {
    for (const std::int32_t cap : {255, 5120, 65535}) {
      for (const std::int32_t reach : {1, 2, 3}) {
        const MinorantField field = drawn_field(cap, static_cast<std::uint64_t>(cap + reach));
        const std::uint32_t unit = FieldMinorant::unit_for(static_cast<std::uint32_t>(cap));
        const FieldMinorant::Params params{.width = kFieldWide,
                                           .height = kFieldHigh,
                                           .stride = kFieldStride,
                                           .cap = static_cast<std::uint32_t>(cap),
                                           .reach = static_cast<std::uint32_t>(reach),
                                           .constant_unit = unit};
        constexpr std::int32_t kMinorantsWide = kFieldWide + 2 * kAround;
        constexpr std::int32_t kMinorantsHigh = kFieldHigh + 2 * kAround;
        std::vector<std::uint32_t> words(static_cast<std::size_t>(kMinorantsWide * kMinorantsHigh));
        field_minorant_host(isa, params, field.cells.data(), words.data());
        for (std::int32_t row = 0; row < kMinorantsHigh; ++row) {
          for (std::int32_t column = 0; column < kMinorantsWide; ++column) {
            const std::uint32_t word = words[static_cast<std::size_t>(row * kMinorantsWide + column)];
            const MinorantWord expected =
                word_by_definition(field, column - kAround, row - kAround, reach, static_cast<std::int32_t>(unit));
            ASSERT_EQ(static_cast<std::int16_t>(word), expected.constant)
                << cap << ' ' << reach << ' ' << row << ' ' << column;
            ASSERT_EQ(static_cast<std::int8_t>(word >> 16U), expected.slope_x) << cap << ' ' << row << ' ' << column;
            ASSERT_EQ(static_cast<std::int8_t>(word >> 24U), expected.slope_y) << cap << ' ' << row << ' ' << column;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace gdtslam::test
