// Helpers that the case lists of the kernels share.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "gdtslam/compute/kernel_cases.hpp"
#include "gdtslam/compute/kernels/edt.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {

/// A size of grid that cases are made for.
struct CaseSize {
  std::uint32_t width;
  std::uint32_t height;
  std::uint32_t stride;
};

/// Empty, single, one wide, one high, below, at and beyond vector and tile sizes, primes; strides with and without
/// padding.
inline constexpr CaseSize kCaseSizes[] = {{0, 0, 0},    {1, 1, 4},     {1, 9, 32},   {9, 1, 12},     {2, 2, 4},
                                          {7, 8, 8},    {8, 7, 32},    {15, 16, 16}, {31, 33, 32},   {63, 65, 64},
                                          {64, 64, 64}, {127, 3, 128}, {3, 127, 32}, {211, 97, 224}, {257, 131, 288}};

inline std::string size_name(CaseSize size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

/// A seed for the generator from what a case is called, so that adding a case changes no other (FNV-1a).
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

/// A list of values as a buffer.
template <class T>
CaseBuffer list_buffer(const std::vector<T>& values) {
  const auto count = static_cast<std::uint32_t>(values.size());
  return grid_buffer(CaseSize{count, 1, count}, values);
}

/// A grid of noise: what a kernel must overwrite, or must be able to read whatever it is.
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

/// Appends a row whose contents `make(name)` builds when they are asked for.
template <class K, class Make>
void add_case(std::vector<KernelCaseSource>& list, std::string name, Make make, bool benchmark = false) {
  list.push_back({&K::info(), name, benchmark, [name, make] { return make(name); }});
}

void add_edt_cases(std::vector<KernelCaseSource>& list);
void add_jump_flood_cases(std::vector<KernelCaseSource>& list);
void add_field_cases(std::vector<KernelCaseSource>& list);
void add_pose_cost_cases(std::vector<KernelCaseSource>& list);
void add_merge_cases(std::vector<KernelCaseSource>& list);
void add_lattice_cases(std::vector<KernelCaseSource>& list);
void add_map_cases(std::vector<KernelCaseSource>& list);
void add_pose_simplex_cases(std::vector<KernelCaseSource>& list);
void add_choose_pose_cases(std::vector<KernelCaseSource>& list);

}  // namespace gdtslam
