// The expected numbers are those of the published algorithms, computed with Python's integers and mpmath.
#include "gdtslam/core/random.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>

namespace gdtslam {
namespace {

constexpr std::size_t kDraws = 200000;

TEST(Random, GivesThePublishedGeneratorsBits) {
  constexpr std::array<std::uint64_t, 8> kSeedOne = {0xB3F2AF6D0FC710C5U, 0x853B559647364CEAU, 0x92F89756082A4514U,
                                                     0x642E1C7BC266A3A7U, 0xB27A48E29A233673U, 0x24C123126FFDA722U,
                                                     0x123004EF8DF510E6U, 0x61954DCC47B1E89DU};
  Random random(1);
  for (const std::uint64_t expected : kSeedOne) {
    EXPECT_EQ(random.bits(), expected);
  }
  for (int i = 0; i < 991; ++i) {
    random.bits();
  }
  EXPECT_EQ(random.bits(), 0xB8517C33C344D153U);
  EXPECT_EQ(Random(0).bits(), 0x99EC5F36CB75F2B4U);
  EXPECT_EQ(Random(0xFFFFFFFFFFFFFFFFU).bits(), 0x8F5520D52A7EAD08U);
}

TEST(Random, UniformIsTheUpper53Bits) {
  Random random(1);
  EXPECT_EQ(random.uniform(), 0x1.67e55eda1f8e2p-1);
  EXPECT_EQ(random.uniform(), 0x1.0a76ab2c8e6c9p-1);
  EXPECT_EQ(random.uniform(), 0x1.25f12eac10548p-1);
  EXPECT_EQ(random.uniform(), 0x1.90b871ef099a8p-2);
}

TEST(Random, NormalIsThePolarMethod) {
  Random random(1);
  for (const double expected : {1.8843961047879769, 0.18978089448693038, 1.302090250702661, -1.9094343319583577,
                                0.43832091511541005, -0.79232724226381722}) {
    EXPECT_NEAR(random.normal(), expected, 1e-15);
  }
}

TEST(Random, UniformStaysBelowItsUpperEnd) {
  Random random(6);
  const double low = 1.0;
  const double high = std::nextafter(low, 2.0);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(random.uniform(low, high), low) << "one double lies in the interval";
  }
  EXPECT_EQ(random.uniform(2.0, 2.0), 2.0) << "an empty interval gives its end";
  for (int i = 0; i < 1000; ++i) {
    const double draw = random.uniform(-3.0, 5.0);
    EXPECT_GE(draw, -3.0);
    EXPECT_LT(draw, 5.0);
  }
}

TEST(Random, BelowHasNoModuloBias) {
  Random random(7);
  // With plain modulo the lower half of the results would come up twice as often as the upper half.
  constexpr std::uint64_t kCount = 3ULL << 62U;
  std::size_t low = 0;
  for (std::size_t i = 0; i < kDraws; ++i) {
    const std::uint64_t draw = random.below(kCount);
    ASSERT_LT(draw, kCount);
    low += draw < (1ULL << 62U) ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(low) / static_cast<double>(kDraws), 1.0 / 3.0, 0.0053);
}

TEST(Random, SplitDependsOnSeedAndNameAlone) {
  EXPECT_EQ(Random(1).split(7).bits(), 0x8B9C0AAB5AFB687AU);
  Random used(1);
  used.normal();
  used.bits();
  EXPECT_EQ(used.split(7).bits(), 0x8B9C0AAB5AFB687AU) << "draws before the split must not move it";
  EXPECT_NE(Random(1).split(8).bits(), 0x8B9C0AAB5AFB687AU);
  EXPECT_NE(Random(1).split(7).split(7).bits(), 0x8B9C0AAB5AFB687AU);
}

}  // namespace
}  // namespace gdtslam
