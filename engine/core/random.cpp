#include "gdtslam/core/random.hpp"

#include <bit>
#include <cassert>
#include <cmath>

#include "elementary.hpp"

namespace gdtslam {
namespace {

// splitmix64 [Steele2014]: spreads a seed over a generator's state.
std::uint64_t splitmix64(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15U;
  std::uint64_t z = state;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

}  // namespace

Random::Random(std::uint64_t seed) : key_(seed) {
  for (std::uint64_t& word : state_) {
    word = splitmix64(seed);
  }
}

std::uint64_t Random::bits() {
  const std::uint64_t result = std::rotl(state_[1] * 5U, 7) * 9U;
  const std::uint64_t shifted = state_[1] << 17U;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }

double Random::uniform(double low, double high) {
  const double draw = low + (high - low) * uniform();
  // Rounding can lift the largest draws to `high`, which is not part of the interval.
  return draw < high ? draw : std::nextafter(high, low);
}

std::uint64_t Random::below(std::uint64_t count) {
  assert(count > 0);
  // The lowest 2^64 mod count values would make some results likelier than others.
  const std::uint64_t first_fair = (0U - count) % count;
  std::uint64_t draw = bits();
  while (draw < first_fair) {
    draw = bits();
  }
  return draw % count;
}

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double u = 0.0;
  double v = 0.0;
  double sq_radius = 0.0;
  do {
    u = 2.0 * uniform() - 1.0;
    v = 2.0 * uniform() - 1.0;
    sq_radius = u * u + v * v;
  } while (sq_radius >= 1.0 || sq_radius == 0.0);
  const double scale = std::sqrt(-2.0 * log(sq_radius) / sq_radius);
  spare_ = v * scale;
  has_spare_ = true;
  return u * scale;
}

// Derived from the key and not from the state, so that earlier draws do not change the stream. Both steps are
// one-to-one: two streams of one generator never share a seed.
Random Random::split(std::uint64_t stream) const {
  std::uint64_t key = key_;
  std::uint64_t mixed = splitmix64(key) ^ stream;
  return Random(splitmix64(mixed));
}

}  // namespace gdtslam
