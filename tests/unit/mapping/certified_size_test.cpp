// Fields that are too large for offsets of 32 bits are refused before anything is read or taken.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

#include "engine/mapping/certified/field.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::uint64_t kMostSide = 0xFFFFFFFFU;

bool is_countable(std::uint64_t width, std::uint64_t height, CertifiedMap::Windows windows) {
  try {
    BoundFields::require_countable(width, height, windows);
  } catch (const InputError& error) {
    EXPECT_EQ(error.code(), ExitCode::kBadInput);
    return false;
  }
  return true;
}

// Of the narrowest boxes there are four samples a cell, with margins; of minorants three words.
TEST(CertifiedSize, FourSamplesACellMustBeCounted) {
  for (const auto windows : {CertifiedMap::kAnyWindows, CertifiedMap::kSmallWindows, CertifiedMap::kNearWindows}) {
    for (const auto& [width, height] : {std::pair(4U, 4U), std::pair(32000U, 32000U), std::pair(4U, 2000000U)}) {
      EXPECT_TRUE(is_countable(width, height, windows)) << width << " x " << height;
      EXPECT_TRUE(is_countable(height, width, windows)) << height << " x " << width;
    }
    for (const auto& [width, height] :
         {std::pair(32768U, 32768U), std::pair(38000U, 38000U), std::pair(4U, 1U << 30U), std::pair(1000000U, 1074U)}) {
      EXPECT_FALSE(is_countable(width, height, windows)) << width << " x " << height;
      EXPECT_FALSE(is_countable(height, width, windows)) << height << " x " << width;
    }
  }
}

// Where products of 64 bits would begin again at 0.
TEST(CertifiedSize, TheLargestSidesThereAreAreRefused) {
  for (const std::uint64_t side : {std::uint64_t{1} << 31U, (std::uint64_t{1} << 31U) - 1, kMostSide}) {
    EXPECT_FALSE(is_countable(side, side, CertifiedMap::kAnyWindows)) << side;
    EXPECT_FALSE(is_countable(side, side, CertifiedMap::kNearWindows)) << side;
  }
}

TEST(CertifiedSize, OfAFieldIsLookedAtFirst) {
  const FieldView field{
      .cells = nullptr, .width = 38000, .height = 38000, .stride = 38000, .first_cell = {}, .cap = 2560};
  EXPECT_THAT([&] { const BoundFields fields(field, Isa::kBaseline, CertifiedMap::kAnyWindows); },
              ThrowsMessage<InputError>(HasSubstr("38000 x 38000 cells is too large")));
}

}  // namespace
}  // namespace gdtslam
