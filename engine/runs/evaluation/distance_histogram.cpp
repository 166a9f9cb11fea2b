#include "distance_histogram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace gdtslam {
namespace {

constexpr double kBins_per_m = 1e5;
constexpr std::size_t kBins = 1'000'000;
constexpr std::size_t kBins_per_row = 100;
constexpr std::size_t kRows = 1000;

}  // namespace

DistanceHistogram::DistanceHistogram() : bins_(kBins + 1, 0) {}

void DistanceHistogram::add(double distance_m) {
  const double bin = std::min(distance_m * kBins_per_m, static_cast<double>(kBins));
  ++bins_[static_cast<std::size_t>(bin)];
  for (std::size_t i = 0; i < kLimits_m.size(); ++i) beyond_[i] += distance_m > kLimits_m[i] ? 1U : 0U;
  ++count_;
  sum_m_ += distance_m;
  sq_sum_ += distance_m * distance_m;
  max_m_ = std::max(max_m_, distance_m);
}

double DistanceHistogram::mean_m() const { return count_ > 0 ? sum_m_ / static_cast<double>(count_) : 0.0; }

double DistanceHistogram::rms_m() const { return count_ > 0 ? std::sqrt(sq_sum_ / static_cast<double>(count_)) : 0.0; }

double DistanceHistogram::quantile_m(double share) const {
  const double wanted = std::max(std::ceil(share * static_cast<double>(count_)), 1.0);
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    seen += bins_[bin];
    if (static_cast<double>(seen) >= wanted) return std::min(static_cast<double>(bin + 1) / kBins_per_m, max_m_);
  }
  return max_m_;
}

double DistanceHistogram::share_beyond(std::size_t limit) const {
  return count_ > 0 ? static_cast<double>(beyond_[limit]) / static_cast<double>(count_) : 0.0;
}

std::string DistanceHistogram::csv() const {
  std::string text = "from_m,to_m,points,share\n";
  const auto add_row = [&](std::size_t row, const std::string& to, std::uint64_t points) {
    const double share = count_ > 0 ? static_cast<double>(points) / static_cast<double>(count_) : 0.0;
    text += fmt::format("{:.3f},{},{},{:.9f}\n", static_cast<double>(row) / 1000.0, to, points, share);
  };
  std::uint64_t rest = count_;
  for (std::size_t row = 0; row < kRows; ++row) {
    std::uint64_t points = 0;
    for (std::size_t bin = 0; bin < kBins_per_row; ++bin) points += bins_[row * kBins_per_row + bin];
    add_row(row, fmt::format("{:.3f}", static_cast<double>(row + 1) / 1000.0), points);
    rest -= points;
  }
  add_row(kRows, "inf", rest);
  return text;
}

nlohmann::ordered_json DistanceHistogram::json() const {
  using Json = nlohmann::ordered_json;
  const auto value = [this](double number) { return count_ > 0 ? Json(number) : Json(); };
  Json beyond = Json::array();
  for (std::size_t i = 0; i < kLimits_m.size(); ++i) {
    beyond.push_back({{"limit_m", kLimits_m[i]}, {"share", value(share_beyond(i))}});
  }
  return {{"count", count_},
          {"mean", value(mean_m())},
          {"rms", value(rms_m())},
          {"median", value(quantile_m(0.5))},
          {"p90", value(quantile_m(0.9))},
          {"max", value(max_m_)},
          {"beyond", beyond}};
}

std::string DistanceHistogram::text() const {
  std::string text = "      points      mean       rms    median      90 %       max\n";
  text += fmt::format("{:>12} {:>9.6f} {:>9.6f} {:>9.6f} {:>9.6f} {:>9.6f}  m\n", count_, mean_m(), rms_m(),
                      quantile_m(0.5), quantile_m(0.9), max_m_);
  text += "beyond";
  for (std::size_t i = 0; i < kLimits_m.size(); ++i) {
    text += fmt::format("{} {:g} cm: {:.3f} %", i > 0 ? "," : "", 100.0 * kLimits_m[i], 100.0 * share_beyond(i));
  }
  return text + "\n";
}

}  // namespace gdtslam
