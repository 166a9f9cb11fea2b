#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "gdtslam/core/units.hpp"

namespace gdtslam {
namespace {

rc::Gen<Unit> any_unit() {
  return rc::gen::element(Unit::kNone, Unit::kMetre, Unit::kRadian, Unit::kSecond, Unit::kCell, Unit::kShare);
}

// Every bit pattern of a finite double, subnormals included.
rc::Gen<double> any_finite() {
  return rc::gen::suchThat(rc::gen::map(rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint64_t>()),
                                        [](std::uint64_t bits) { return std::bit_cast<double>(bits); }),
                           [](double value) { return std::isfinite(value); });
}

RC_GTEST_PROP(Units, FormatAndParseRoundTripEveryBit, ()) {
  const double value = *any_finite();
  const Unit unit = *any_unit();
  std::string why;
  const auto back = parse_quantity(format_quantity(value, unit), unit, &why);
  RC_ASSERT(back.has_value());
  RC_ASSERT(std::bit_cast<std::uint64_t>(*back) == std::bit_cast<std::uint64_t>(value));
}

// A decimal unit moves the point: n cm is the double nearest to the decimal fraction, as the compiler would read it.
RC_GTEST_PROP(Units, DecimalUnitsRoundOnce, ()) {
  const auto count = *rc::gen::inRange<std::int64_t>(-1000000, 1000000);
  const std::string text = std::to_string(count);
  double expected = 0.0;
  const std::string shifted = text + "e-3";
  std::from_chars(shifted.data(), shifted.data() + shifted.size(), expected);
  RC_ASSERT(parse_quantity(text + " mm", Unit::kMetre, nullptr) == expected);
  RC_ASSERT(parse_quantity(text + "ms", Unit::kSecond, nullptr) == expected);
}

RC_GTEST_PROP(Units, AnyTextGivesAFiniteValueOrAReason, ()) {
  const auto text = *rc::gen::container<std::string>(
      rc::gen::oneOf(rc::gen::elementOf(std::string("0123456789+-.eE cmradegs%\t")), rc::gen::arbitrary<char>()));
  std::string why;
  const auto value = parse_quantity(text, *any_unit(), &why);
  const bool is_as_promised = value.has_value() ? std::isfinite(*value) && why.empty() : !why.empty();
  RC_ASSERT(is_as_promised);
}

RC_GTEST_PROP(Units, DegreesAreRightToOneUlp, ()) {
  const auto tenths = *rc::gen::inRange<std::int64_t>(-36000, 36000);
  const auto found = parse_quantity(std::to_string(tenths / 10) + "." + std::to_string(std::abs(tenths % 10)) + " deg",
                                    Unit::kRadian, nullptr);
  RC_PRE(tenths / 10 != 0);  // "-0.5" is not what the two parts above give
  const long double expected = static_cast<long double>(tenths) * 3.14159265358979323846264338327950288L / 1800.0L;
  RC_ASSERT(std::fabs(static_cast<double>(static_cast<long double>(*found) - expected)) <=
            2.3e-16 * std::fabs(static_cast<double>(expected)));
}

}  // namespace
}  // namespace gdtslam
