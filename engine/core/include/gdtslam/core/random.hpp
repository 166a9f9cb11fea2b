// Random numbers that are the same on every host and with every standard library: xoshiro256** [Blackman2021] seeded by
// splitmix64, with uniform and normal draws of its own. Not thread-safe; give each stream its own generator.
#pragma once

#include <array>
#include <cstdint>

namespace gdtslam {

/// One stream of numbers from one seed.
class Random {
 public:
  explicit Random(std::uint64_t seed);

  /// The next 64 random bits.
  std::uint64_t bits();
  /// Uniform in [0, 1), 53 bits.
  double uniform();
  /// Uniform in [low, high).
  double uniform(double low, double high);
  /// Uniform integer in [0, count), without modulo bias; count > 0.
  std::uint64_t below(std::uint64_t count);
  /// Standard normal, by the polar method with the project's own logarithm.
  double normal();
  double normal(double mean, double deviation) { return mean + deviation * normal(); }
  /// An independent stream for a named purpose. It depends on the seed and the name alone, not on earlier draws, so an
  /// added draw does not change any other stream.
  [[nodiscard]] Random split(std::uint64_t stream) const;

 private:
  std::uint64_t key_;
  std::array<std::uint64_t, 4> state_{};
  bool has_spare_ = false;
  double spare_ = 0.0;
};

}  // namespace gdtslam
