// How fast this machine is now, for bounds on processor time: on a shared host the neighbours take the caches.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <vector>

namespace gdtslam::test {

/// How many times longer than on an undisturbed machine a dependent load from 16 MB takes, which the last level of the
/// cache answers in 70 cycles (Intel's optimisation manual, Skylake server), with the walk of the page table 30 ns at
/// 3 GHz. At least 1. Takes 0.1 to 0.5 s.
inline double slowdown() {
  constexpr std::size_t kLoads = 3'000'000;
  constexpr double kUndisturbed_s = 30e-9 * kLoads;
  std::vector<std::uint32_t> next(std::size_t{1} << 22U);
  for (std::size_t i = 0; i < next.size(); ++i) next[i] = static_cast<std::uint32_t>(i * 2654435761U) & 0x3FFFFFU;
  const std::clock_t start = std::clock();
  std::uint32_t at = 1;
  for (std::size_t i = 0; i < kLoads; ++i) at = next[at] ^ static_cast<std::uint32_t>(i & 0xFFU);
  const double taken_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return at > next.size() ? 0.0 : std::max(1.0, taken_s / kUndisturbed_s);
}

}  // namespace gdtslam::test
