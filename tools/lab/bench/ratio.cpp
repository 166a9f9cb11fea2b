#include "ratio.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/core/quantile.hpp"

namespace gdtslam {
namespace {

constexpr double kTail = 0.025;
constexpr double kTailDeviations = 1.959964;  // of the normal distribution, beyond which that much lies
constexpr std::size_t kMostCounted = 60;      // samples of both sides, whose ranks are counted; of more U is normal

/// The probabilities of U = 0 ... n m: of n chosen among the first k ranks, what the sum of their ranks exceeds its
/// least by. One rank after the other, each chosen or not.
std::vector<double> mann_whitney_probabilities(std::size_t n, std::size_t m) {
  const std::size_t most = n * m;
  std::vector<std::vector<double>> ways(n + 1, std::vector<double>(most + 1, 0.0));
  ways[0][0] = 1.0;
  for (std::size_t rank = 0; rank < n + m; ++rank) {
    for (std::size_t chosen = std::min(rank + 1, n); chosen > 0; --chosen) {
      const std::size_t above = rank + 1 - chosen;  // ranks not chosen that lie below this one
      for (std::size_t u = most + 1; u-- > above;) ways[chosen][u] += ways[chosen - 1][u - above];
    }
  }
  double all = 0.0;
  for (const double count : ways[n]) all += count;
  for (double& count : ways[n]) count /= all;
  return ways[n];
}

/// Quotients that are left out at each end, and the probability of what lies there. One at each end stays.
struct Tail {
  std::size_t left_out = 0;
  double probability = 0.0;
};
Tail counted_tail(std::size_t n, std::size_t m) {
  const std::vector<double> probabilities = mann_whitney_probabilities(n, m);
  Tail tail{0, probabilities[0]};
  while (2 * (tail.left_out + 2) <= n * m && tail.probability + probabilities[tail.left_out + 1] <= kTail) {
    tail.probability += probabilities[++tail.left_out];
  }
  return tail;
}
Tail normal_tail(std::size_t n, std::size_t m) {
  const double pairs = static_cast<double>(n) * static_cast<double>(m);
  const double deviation = std::sqrt(pairs * static_cast<double>(n + m + 1) / 12.0);
  const double place = std::floor(0.5 * pairs - 0.5 - kTailDeviations * deviation);
  return place < 0.0 ? Tail{0, 0.5} : Tail{static_cast<std::size_t>(place), kTail};
}

}  // namespace

double mann_whitney_share(std::size_t n, std::size_t m, std::size_t most) {
  const std::vector<double> probabilities = mann_whitney_probabilities(n, m);
  double share = 0.0;
  for (std::size_t u = 0; u <= std::min(most, n * m); ++u) share += probabilities[u];
  return share;
}

TimesRatio times_ratio(std::span<const double> before_s, std::span<const double> now_s) {
  assert(!before_s.empty() && !now_s.empty());
  std::vector<double> quotients;
  quotients.reserve(before_s.size() * now_s.size());
  for (const double before : before_s) {
    for (const double now : now_s) quotients.push_back(before / now);
  }
  std::sort(quotients.begin(), quotients.end());
  const std::size_t n = before_s.size();
  const std::size_t m = now_s.size();
  const Tail tail = n + m <= kMostCounted ? counted_tail(n, m) : normal_tail(n, m);
  return {.middle = quantile_of_sorted(quotients, 0.5),
          .least = quotients[tail.left_out],
          .most = quotients[quotients.size() - 1 - tail.left_out],
          .confidence = std::max(0.0, 1.0 - 2.0 * tail.probability)};
}

}  // namespace gdtslam
