// Statistics of many points' distances in bounded memory: mean and root mean square are exact, quantiles to 10 um. One
// object belongs to one thread. Memory: 8 MB.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace gdtslam {

class DistanceHistogram {
 public:
  /// Distances in metres for share_beyond().
  static constexpr std::array kLimits_m{0.001, 0.01, 0.03, 0.1};

  DistanceHistogram();
  /// At least 0.
  void add(double distance_m);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// 0 without points, like the next three.
  [[nodiscard]] double mean_m() const;
  [[nodiscard]] double rms_m() const;
  [[nodiscard]] double max_m() const { return max_m_; }
  /// The quantile of that share, rounded up to 10 um; beyond 10 m the largest distance.
  [[nodiscard]] double quantile_m(double share) const;
  /// Share of the points farther away than kLimits_m[limit].
  [[nodiscard]] double share_beyond(std::size_t limit) const;

  /// Rows `from_m,to_m,points,share` a millimetre wide up to 1 m, then one for all beyond.
  [[nodiscard]] std::string csv() const;
  [[nodiscard]] nlohmann::ordered_json json() const;
  /// A heading and a row, then a line of shares.
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::uint64_t> bins_;  ///< bins of 10 um; the last holds all larger distances
  std::array<std::uint64_t, kLimits_m.size()> beyond_{};
  std::uint64_t count_ = 0;
  double sum_m_ = 0.0;
  double sq_sum_ = 0.0;
  double max_m_ = 0.0;
};

}  // namespace gdtslam
