#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/elementary.hpp"
#include "gdtslam/drawing/plot.hpp"
#include "output.hpp"

namespace gdtslam {
namespace {

/// Colour of a method, the same in all figures.
Colour colour_of_method(MatcherKind method) {
  static constexpr std::array kColours{ink::kCoupler, ink::kCrank,  ink::kRocker, ink::kCurve,
                                       ink::kLaser,   ink::kGround, ink::kQuiet,  ink::kText};
  return kColours.at(static_cast<std::size_t>(method) % kColours.size());
}

constexpr double kWidth = 1180.0;
constexpr double kMargin = 24.0;
constexpr double kGap = 16.0;
constexpr double kHeading = 64.0;
constexpr double kBasinHeight = 440.0;
constexpr double kLeastError_cm = 1.0e-3;  // limit of the logarithmic axes; smaller errors are drawn there
constexpr double kLeastPower = -3.0;

constexpr double kLn10 = 2.302585092994046;
double log10_of(double value) { return log(value) / kLn10; }
double error_axis(double distance_m) { return log10_of(std::max(100.0 * distance_m, kLeastError_cm)); }

std::string_view method_dashes(MatcherKind method) {
  const MatcherInfo& matcher = matcher_info(method);
  if (matcher.proves_windows) return "2 4";
  if (matcher.always_searches) return "8 4";
  return matcher.follows_slope ? "10 3 2 3" : "";
}

/// Not a number without trials; such values are not drawn.
double percent(const Share& share, double value) {
  return share.of > 0 ? 100.0 * value : std::numeric_limits<double>::quiet_NaN();
}

void draw_basin(Canvas& canvas, const DrawingArea& area, const CompareJob& job, const CompareOutcome& outcome) {
  Axis x{.title = "Start: distance and angle from the proven solution", .from = -0.35, .has_grid = true};
  x.to = static_cast<double>(job.levels.size()) - 0.65;
  for (std::uint32_t level = 1; level <= job.levels.size(); ++level) {
    x.names.emplace_back(static_cast<double>(level - 1), level_text(job, level));
  }
  Plot plot(canvas, area, x, {.title = "Success (%)", .from = 0.0, .to = 103.0},
            {.title = fmt::format("Ends within {:g} cm and {:g}° of the solution; bands: 95 %", 100.0 * kSuccess_m,
                                  kSuccess_deg)});
  std::vector<std::vector<MethodFigures>> levels;
  for (std::uint32_t level = 1; level <= job.levels.size(); ++level) {
    levels.push_back(sum_figures(job, outcome, level, ScanKind::kHeld));
  }
  for (std::size_t k = 0; k < job.methods.size(); ++k) {
    std::vector<Point2> low;
    std::vector<Point2> high;
    for (std::size_t level = 0; level < levels.size(); ++level) {
      const Share& share = levels[level][k].success;
      low.emplace_back(static_cast<double>(level), percent(share, share.low()));
      high.emplace_back(static_cast<double>(level), percent(share, share.high()));
    }
    plot.band(low, high, {colour_of_method(job.methods[k]), 0.10});
  }
  for (std::size_t k = 0; k < job.methods.size(); ++k) {
    std::vector<Point2> values;
    for (std::size_t level = 0; level < levels.size(); ++level) {
      const Share& share = levels[level][k].success;
      values.emplace_back(static_cast<double>(level), percent(share, share.value()));
    }
    const Colour colour = colour_of_method(job.methods[k]);
    plot.line(values, {.colour = colour, .width = 2.2, .dashes = method_dashes(job.methods[k])},
              to_string(job.methods[k]));
    plot.markers(values, {colour}, 3.0);
  }
  plot.legend();
}

/// Axis of logarithms with ticks at whole powers of ten.
Axis logarithmic(const std::string& title, double most_cm) {
  Axis axis{.title = title, .from = kLeastPower};
  axis.to = std::max(std::ceil(log10_of(std::max(most_cm, 10.0 * kLeastError_cm))), axis.from + 1.0);
  constexpr std::array kNames{"≤ 0.001", "0.01", "0.1", "1", "10", "100", "1000"};
  for (std::size_t k = 0; k < kNames.size() && axis.from + static_cast<double>(k) <= axis.to; ++k) {
    axis.names.emplace_back(axis.from + static_cast<double>(k), kNames[k]);
  }
  return axis;
}

double largest_cm(const CompareJob& job, const CompareOutcome& outcome) {
  double most = 0.0;
  for (std::uint32_t k = 0; k < job.methods.size(); ++k) {
    for (const double distance : collect_distances(outcome, k, 0, ScanKind::kHeld))
      most = std::max(most, 100.0 * distance);
  }
  return most;
}

void draw_boxes(Canvas& canvas, const DrawingArea& area, const CompareJob& job, const CompareOutcome& outcome) {
  Axis x{.from = -0.6, .to = static_cast<double>(job.methods.size()) - 0.4, .has_grid = false};
  for (std::size_t k = 0; k < job.methods.size(); ++k) {
    x.names.emplace_back(static_cast<double>(k), std::string(to_string(job.methods[k])));
  }
  Plot plot(canvas, area, x, logarithmic("Distance from the solution (cm)", largest_cm(job, outcome)),
            {.title = "Started where the odometry says"});
  for (std::size_t k = 0; k < job.methods.size(); ++k) {
    std::vector<double> values = collect_distances(outcome, static_cast<std::uint32_t>(k), 0, ScanKind::kHeld);
    if (values.empty()) continue;
    std::transform(values.begin(), values.end(), values.begin(), error_axis);
    plot.box(static_cast<double>(k), 0.5, box_figures(std::move(values)), colour_of_method(job.methods[k]));
  }
}

void draw_distribution(Canvas& canvas, const DrawingArea& area, const CompareJob& job, const CompareOutcome& outcome) {
  const Axis x = logarithmic("Distance from the solution (cm)", largest_cm(job, outcome));
  Plot plot(canvas, area, x, {.title = "Scans (%)", .from = 0.0, .to = 103.0},
            {.title = "Share of scans up to a distance"});
  for (std::size_t k = 0; k < job.methods.size(); ++k) {
    std::vector<double> values = collect_distances(outcome, static_cast<std::uint32_t>(k), 0, ScanKind::kHeld);
    if (values.empty()) continue;
    std::sort(values.begin(), values.end());
    std::vector<Point2> steps{{x.from, 0.0}};
    for (std::size_t i = 0; i < values.size(); ++i) {
      steps.emplace_back(error_axis(values[i]),
                         100.0 * static_cast<double>(i + 1) / static_cast<double>(values.size()));
    }
    steps.emplace_back(x.to, 100.0);
    plot.steps(steps,
               {.colour = colour_of_method(job.methods[k]), .width = 1.8, .dashes = method_dashes(job.methods[k])},
               to_string(job.methods[k]));
  }
  plot.legend();
}

}  // namespace

Canvas compare_picture(const CompareJob& job, const CompareOutcome& outcome, const std::string& log) {
  const double top = kMargin + kHeading;
  const bool has_levels = !job.levels.empty();
  const double lower = has_levels ? top + kBasinHeight + kGap : top;
  const double lower_height = 330.0;
  Canvas canvas(kWidth, lower + lower_height + kMargin, "Minimisers of the cost of a scan, compared on " + log);
  canvas.rectangle({0.0, 0.0}, canvas.width(), canvas.height(), Fill{kLightTheme.page});
  canvas.text({kMargin, kMargin + 18.0}, "Minimisers compared on " + log, {.size = 20.0, .is_bold = true});
  canvas.text({kMargin, kMargin + 40.0},
              fmt::format("{} scans whose global solution is proven within {:g} mm of the mean distance; {} weak along "
                          "a corridor and {} without a proof are left out",
                          count_kind(outcome, ScanKind::kHeld), 1000.0 * job.global.gap_m,
                          count_kind(outcome, ScanKind::kWeak), count_kind(outcome, ScanKind::kUncertain)),
              {.size = 13.0, .colour = ink::kQuiet});
  const double width = kWidth - 2.0 * kMargin;
  if (has_levels) draw_basin(canvas, {{kMargin, top}, width, kBasinHeight}, job, outcome);
  const double half = 0.5 * (width - kGap);
  draw_boxes(canvas, {{kMargin, lower}, half, lower_height}, job, outcome);
  draw_distribution(canvas, {{kMargin + half + kGap, lower}, half, lower_height}, job, outcome);
  return canvas;
}

}  // namespace gdtslam
