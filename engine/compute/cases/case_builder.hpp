// Helpers that the case lists of the kernels share.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/random.hpp"
#include "kernel_cases.hpp"

namespace gdtslam {

/// A size of grid for cases.
struct CaseSize {
  std::uint32_t width;
  std::uint32_t height;
  std::uint32_t stride;
};

/// Empty, single, one wide, one high, below, at and beyond vector and tile sizes, primes; strides with and without
/// padding. They are combined with every parameter; sides up to 15 are also tried in all pairs.
inline constexpr CaseSize kCaseSizes[] = {{0, 0, 0},    {1, 1, 4},      {1, 9, 32},      {9, 1, 12},
                                          {2, 2, 4},    {7, 8, 8},      {8, 7, 32},      {15, 16, 16},
                                          {31, 33, 32}, {63, 65, 64},   {64, 64, 64},    {128, 3, 128},
                                          {3, 127, 32}, {211, 97, 224}, {257, 131, 288}, {101, 103, 104}};
/// Long and thin sizes, and one like a scan's window: tried with few parameters.
inline constexpr CaseSize kLongSizes[] = {
    {1021, 3, 1024}, {2, 1019, 4}, {4096, 1, 4096}, {1, 4096, 4}, {333, 250, 336}};
/// Sizes of the largest maps, and primes.
inline constexpr CaseSize kLargeSizes[] = {{4096, 4096, 4096}, {2039, 1021, 2052}};
/// Largest side of the sizes tried in all pairs.
inline constexpr std::uint32_t kSmallSide = 15;

inline std::string size_name(CaseSize size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

/// Calls add(size) for those kCaseSizes that for_each_small_size does not include.
template <class Add>
void for_each_size(Add add) {
  for (const CaseSize& size : kCaseSizes) {
    if (size.width > kSmallSide || size.height > kSmallSide) {
      add(size);
    }
  }
}

/// Calls add(size, turn) for all pairs of sides from 0 to kSmallSide. Strides and `turn` change from size to size;
/// `turn` selects the next parameter of a list.
template <class Add>
void for_each_small_size(Add add) {
  for (std::uint32_t height = 0; height <= kSmallSide; ++height) {
    for (std::uint32_t width = 0; width <= kSmallSide; ++width) {
      const std::uint32_t turn = height * 7 + width;  // 7 has no factor in common with the lengths of the lists
      const std::uint32_t padding = 4 * (turn % 3);
      add(CaseSize{width, height, (width + 3) / 4 * 4 + padding}, turn);
    }
  }
}

/// The element of a list for this turn.
template <class T, std::size_t kCount>
T in_turn(const T (&list)[kCount], std::uint32_t turn) {
  return list[turn % kCount];
}

/// A number that a device may flush to 0 (below 2^-126): no result may depend on it.
inline constexpr float kSubnormal = 1.0e-40F;

/// Largest distances of the transforms' cases, in cells.
inline constexpr std::uint32_t kCaseRadii[] = {1, 20, 255};

/// Patterns of seeds that are combined with the sizes.
inline constexpr SeedPattern kCasePatterns[] = {SeedPattern::kNone, SeedPattern::kOne, SeedPattern::kSparse,
                                                SeedPattern::kHalf, SeedPattern::kAll, SeedPattern::kChecks};

/// A seed for the generator from the case's name, so that a new case changes no other (FNV-1a).
inline std::uint64_t seed_from(std::string_view text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  }
  return hash;
}

/// The values of a grid as a buffer.
template <class T>
CaseBuffer grid_buffer(CaseSize size, const std::vector<T>& values) {
  CaseBuffer buffer{{sizeof(T), size.width, size.height, size.stride},
                    std::vector<std::byte>(values.size() * sizeof(T))};
  if (!values.empty()) {
    std::memcpy(buffer.content.data(), values.data(), buffer.content.size());
  }
  return buffer;
}

/// Layout in strips, a few cells apart, for a field of this size.
inline FieldLayout strips_for(CaseSize size, std::uint32_t blank) {
  return {kStripStride, kStripStride * size.height + 8, blank};
}

/// The values of a grid in such strips, including the 65th cells; other values between the strips.
std::vector<std::uint16_t> in_strips(CaseSize size, const std::vector<std::uint16_t>& values,
                                     const FieldLayout& layout);

/// A list of values as a buffer.
template <class T>
CaseBuffer list_buffer(const std::vector<T>& values) {
  const auto count = static_cast<std::uint32_t>(values.size());
  return grid_buffer(CaseSize{count, 1, count}, values);
}

/// Seeds of a pattern; the case's name seeds the generator.
inline std::vector<std::uint8_t> seeds_for(SeedPattern pattern, CaseSize size, const std::string& name) {
  return make_seeds(pattern, size.width, size.height, size.stride, seed_from(name));
}

/// A list of words of noise.
CaseBuffer noise_buffer(std::uint32_t words, Random& random);

/// A grid of noise: content that a kernel must overwrite, or may read without an effect.
template <class T>
std::vector<T> noise(CaseSize size, std::uint64_t random_seed) {
  Random random(random_seed);
  std::vector<T> values(std::size_t{size.stride} * size.height);
  for (T& value : values) {
    value = static_cast<T>(random.bits() >> 40U);
  }
  return values;
}

template <class K>
KernelCase make_case(std::string name, const typename K::Params& params, Extent threads,
                     std::vector<CaseBuffer> buffers) {
  KernelCase result;
  result.kernel = &K::info();
  result.name = std::move(name);
  result.params.resize(sizeof(params));
  std::memcpy(result.params.data(), &params, sizeof(params));
  result.threads = threads;
  result.buffers = std::move(buffers);
  return result;
}

/// Purpose of a case: quick runs leave large ones out.
enum class CaseUse : std::uint8_t { kTest, kBenchmark, kLarge };

/// Appends the case of a shape. A shape holds a case's parameters, with its Kernel, its name() and make(name), which
/// builds the contents on demand. `what` is added to the name.
template <class Shape>
void add_case(std::vector<KernelCaseSource>& list, const Shape& shape, const std::string& what = {},
              CaseUse use = CaseUse::kTest) {
  const std::string name = shape.name() + what;
  list.push_back({&Shape::Kernel::info(), name, use == CaseUse::kBenchmark, use == CaseUse::kLarge,
                  [shape, name] { return shape.make(name); }});
}
template <class Shape>
void add_case(std::vector<KernelCaseSource>& list, const Shape& shape, CaseUse use) {
  add_case(list, shape, "", use);
}

/// A kernel and its generator of random cases.
struct RandomKernel {
  const KernelInfo* kernel = nullptr;
  KernelCase (*draw)(const std::string& name, Random& random) = nullptr;
};

/// A number from 0 to `most`; small and large ones are equally likely.
std::uint32_t draw_count(Random& random, std::uint32_t most);
/// A size: mostly up to 80 cells a side, seldom up to 300, seldom long and thin; sides of at least `least`.
CaseSize draw_size(Random& random, std::uint32_t least = 0);
SeedPattern draw_pattern(Random& random);
/// Random 32 bits, and a number from -most to most.
std::uint32_t draw_word(Random& random);
float draw_real(Random& random, double most);
template <class T, std::size_t kCount>
T draw_from(Random& random, const T (&list)[kCount]) {
  return list[random.below(kCount)];
}

/// The cases of one or more kernels, and their generators of random cases. A kernel returns its group from its static
/// function cases(); if several share one, the first does.
struct CaseGroup {
  void (*add)(std::vector<KernelCaseSource>& list) = nullptr;
  std::vector<RandomKernel> draws;
};

}  // namespace gdtslam
