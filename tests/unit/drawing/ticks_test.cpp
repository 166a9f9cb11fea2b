// Round steps by their definition: 1, 2 or 5 times a power of ten, the least that leaves few enough ticks.
#include "gdtslam/drawing/ticks.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace gdtslam {
namespace {

std::vector<std::string> texts(const Ticks& ticks) {
  std::vector<std::string> all;
  for (int i = 0; i < ticks.count; ++i) all.push_back(ticks.text(i));
  return all;
}
using Texts = std::vector<std::string>;

TEST(Ticks, AreRoundAndWithin) {
  EXPECT_EQ(texts(make_ticks(0.0, 1.0, 5)), (Texts{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(texts(make_ticks(-0.3, 2.7, 4)), (Texts{"0", "1", "2"}));
  EXPECT_EQ(texts(make_ticks(0.0, 137.0, 10)), (Texts{"0", "20", "40", "60", "80", "100", "120"}));
  EXPECT_EQ(texts(make_ticks(-25.0, 25.0, 2)), (Texts{"0"}));  // of 50
  EXPECT_EQ(texts(make_ticks(1.0, 1.004, 4)), (Texts{"1.000", "1.001", "1.002", "1.003", "1.004"}));
  EXPECT_EQ(texts(make_ticks(0.0, 4e-8, 4)), (Texts{"0", "1e-08", "2e-08", "3e-08", "4e-08"}));
}

TEST(Ticks, HaveATrueMinusSign) { EXPECT_EQ(texts(make_ticks(-0.1, 0.1, 2)), (Texts{"\u22120.1", "0.0", "0.1"})); }

TEST(Ticks, OfAnglesAreRoundAngles) {
  EXPECT_EQ(make_ticks(0.0, 360.0, 10, TickSteps::kDegrees).step, 45.0);
  EXPECT_EQ(make_ticks(0.0, 360.0, 4, TickSteps::kDegrees).step, 90.0);
  EXPECT_EQ(make_ticks(-45.0, 45.0, 8, TickSteps::kDegrees).step, 15.0);
  EXPECT_EQ(make_ticks(0.0, 9.0, 5, TickSteps::kDegrees).step, 2.0);
  EXPECT_EQ(make_ticks(0.0, 3600.0, 4, TickSteps::kDegrees).step, 1080.0);
}

TEST(Ticks, AroundCoverTheRange) {
  const Ticks ticks = ticks_around(-0.3, 2.7, 5);
  EXPECT_EQ(texts(ticks), (Texts{"\u22121", "0", "1", "2", "3"}));
  EXPECT_EQ(texts(ticks_around(0.0, 1.0, 5)).size(), 6U);  // whole steps already
}

RC_GTEST_PROP(Ticks, AreFewRoundAndAsManyAsFit, ()) {
  const double from = static_cast<double>(*rc::gen::inRange<int>(-100000, 100000)) / 97.0;
  const double span = static_cast<double>(*rc::gen::inRange<int>(1, 10000000)) / 9973.0;
  const int most = *rc::gen::inRange(1, 12);
  const Ticks ticks = make_ticks(from, from + span, most);
  RC_ASSERT(ticks.count <= most + 1);
  const double digit = ticks.step / std::pow(10.0, std::floor(std::log10(ticks.step) + 1e-9));
  RC_ASSERT(std::fabs(digit - 1.0) < 1e-9 || std::fabs(digit - 2.0) < 1e-9 || std::fabs(digit - 5.0) < 1e-9);
  for (int i = 0; i < ticks.count; ++i) {
    RC_ASSERT(ticks.value(i) >= from - 1e-5 * ticks.step);
    RC_ASSERT(ticks.value(i) <= from + span + 1e-5 * ticks.step);
  }
  RC_ASSERT(ticks.value(-1) < from + 1e-5 * ticks.step);
  RC_ASSERT(ticks.value(ticks.count) > from + span - 1e-5 * ticks.step);
  RC_ASSERT(span / ticks.step <= most * (1.0 + 1e-9));
  // The next smaller step would give too many.
  const double smaller = ticks.step * (std::fabs(digit - 5.0) < 1e-9 ? 0.4 : 0.5);
  RC_ASSERT(span / smaller > most * (1.0 - 1e-9));
}

TEST(Lengths, AreSaidInTheUnitThatPeopleUse) {
  EXPECT_EQ(length_text(0.002), "2 mm");
  EXPECT_EQ(length_text(0.01), "1 cm");
  EXPECT_EQ(length_text(0.5), "50 cm");
  EXPECT_EQ(length_text(1.0), "1 m");
  EXPECT_EQ(length_text(200.0), "200 m");
  EXPECT_EQ(length_text(5000.0), "5 km");
}

TEST(Lengths, OfAScaleBarAreTheLargestRoundOnesThatFit) {
  EXPECT_DOUBLE_EQ(round_length_m(4.99), 2.0);
  EXPECT_DOUBLE_EQ(round_length_m(5.0), 5.0);
  EXPECT_DOUBLE_EQ(round_length_m(1.99), 1.0);
  EXPECT_DOUBLE_EQ(round_length_m(0.99), 0.5);
  EXPECT_DOUBLE_EQ(round_length_m(0.0021), 0.002);
  EXPECT_DOUBLE_EQ(round_length_m(1300.0), 1000.0);
  EXPECT_EQ(round_length_m(0.0), 0.0);
  EXPECT_EQ(round_length_m(-3.0), 0.0);
  EXPECT_EQ(round_length_m(std::nan("")), 0.0);
}

}  // namespace
}  // namespace gdtslam
