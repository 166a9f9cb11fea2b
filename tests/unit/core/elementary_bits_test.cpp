// The same bits with every compiler and option: a hash of half a million results of each function. The numbers were
// found equal with GCC 12 at -O0 and -O3, with FMA instructions enabled, and with Clang 14; their accuracy is the
// business of tests/oracle/core. A deliberate change of an elementary function changes them, and every expected hash of
// a log.
#include <bit>
#include <cstdint>
#include <random>

#include <gtest/gtest.h>

#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

// FNV-1a over whole words.
class Hash {
 public:
  void add(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001B3U; }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(float value) { add(std::uint64_t{std::bit_cast<std::uint32_t>(value)}); }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325U;
};

constexpr int kResults = 500000;

// `add` hashes the result for a number in [-1, 1).
template <class Add>
std::uint64_t hash_of(Add add) {
  std::mt19937_64 engine(7);
  Hash hash;
  for (int i = 0; i < kResults; ++i) {
    add(hash, static_cast<double>(static_cast<std::int64_t>(engine())) * 0x1p-63);
  }
  return hash.value();
}

TEST(ElementaryBits, SinCos) {
  const std::uint64_t hash = hash_of([](Hash& sum, double x) {
    for (const double scale : {4.0, 1e5, 1e200}) {
      const SinCos<double> value = sin_cos(x * scale);
      sum.add(value.sin);
      sum.add(value.cos);
    }
  });
  EXPECT_EQ(hash, 0xA89F71F304B7006BU) << std::hex << hash;
}

TEST(ElementaryBits, SinCosSingle) {
  const std::uint64_t hash = hash_of([](Hash& sum, double x) {
    const SinCos<float> value = sin_cos(static_cast<float>(x * 64.0));
    sum.add(value.sin);
    sum.add(value.cos);
  });
  EXPECT_EQ(hash, 0x6CE21E6525CBED49U) << std::hex << hash;
}

TEST(ElementaryBits, Atan2) {
  double last = 0.5;
  const std::uint64_t hash = hash_of([&last](Hash& sum, double x) {
    sum.add(atan2(x, last));
    last = x;
  });
  EXPECT_EQ(hash, 0xDA84C66AD1A4E9CDU) << std::hex << hash;
}

TEST(ElementaryBits, Exp) {
  const std::uint64_t hash = hash_of([](Hash& sum, double x) {
    sum.add(exp(x));
    sum.add(exp(x * 745.0));
  });
  EXPECT_EQ(hash, 0x7646C899F5964980U) << std::hex << hash;
}

TEST(ElementaryBits, Log) {
  const std::uint64_t hash = hash_of([](Hash& sum, double x) {
    sum.add(log(1.0 + x));
    sum.add(log(x * x * 1e300));
  });
  EXPECT_EQ(hash, 0x7440B6D83ECFD875U) << std::hex << hash;
}

}  // namespace
}  // namespace gdtslam
