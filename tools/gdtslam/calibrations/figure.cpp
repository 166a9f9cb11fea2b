#include "figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "calib/calibration/calibration_residual.hpp"
#include "engine/core/elementary.hpp"
#include "engine/core/quantile.hpp"
#include "gdtslam/core/angle.hpp"
#include "plot.hpp"

namespace gdtslam {
namespace {

using calib::CalibrationSurface;
using calib::RangeObservation;
using calib::SweepModel;

constexpr double kWidth = 1320.0;
constexpr double kHeight = 900.0;
constexpr double kPanelWidth = 610.0;
constexpr double kPanelHeight = 366.0;
constexpr double kTop = 112.0;
constexpr int kCurveSteps = 1000;
constexpr std::size_t kMostDots = 1500;  // of a plot, spread evenly
constexpr double kWellInside = 0.98;     // share of the residuals that the scale holds

/// One side of the figure: what is believed of the scanner, before or after.
struct Belief {
  SweepModel model;
  std::vector<CalibrationSurface> surfaces;
  std::string name;
};

/// An observation beside what the belief says of it.
struct Dot {
  double ticks = 0.0;
  double elevation_deg = 0.0;
  double range_m = 0.0;
  double ahead_m = 0.0;  ///< (A1) read backwards: the range projected to the level
  double residual_mm = 0.0;
  bool is_ahead = false;  ///< of the forward beam
  bool is_used = false;   ///< within the elevations of the calibration
};

double least_bearing(const std::vector<RangeObservation>& observations) {
  double least = kPi;
  for (const RangeObservation& seen : observations) least = std::min(least, std::fabs(seen.bearing_rad));
  return least;
}

std::vector<Dot> dots_of(const Belief& belief, const CalibrateOutcome& outcome) {
  std::vector<Dot> dots;
  const double ahead = least_bearing(outcome.observations) + 1e-9;
  const std::size_t step = 1 + outcome.observations.size() / kMostDots;
  for (std::size_t k = 0; k < outcome.observations.size(); k += step) {
    const RangeObservation& seen = outcome.observations[k];
    const std::optional<double> elevation =
        calib::elevation_rad(belief.model, calib::crank_rad(belief.model.encoder, seen.ticks));
    if (!elevation) continue;
    const CalibrationSurface& surface = belief.surfaces[seen.surface];
    const std::optional<double> range =
        calib::surface_range_m(belief.model.mount, surface, *elevation, seen.bearing_rad);
    const double measured = calib::measured_elevation_rad(belief.model.mount, surface, seen, *elevation);
    dots.push_back({.ticks = seen.ticks,
                    .elevation_deg = deg_from_rad(*elevation),
                    .range_m = seen.range_m,
                    .ahead_m = seen.range_m * sin_cos(*elevation).cos,
                    .residual_mm = range ? 1000.0 * (seen.range_m - *range) : std::numeric_limits<double>::quiet_NaN(),
                    .is_ahead = std::fabs(seen.bearing_rad) <= ahead,
                    .is_used = std::fabs(measured) <= outcome.max_elevation_rad});
  }
  return dots;
}

// The range of the forward beam over a turn.
std::vector<Point2> curve_of(const Belief& belief) {
  std::vector<Point2> points;
  for (int k = 0; k <= kCurveSteps; ++k) {
    const double ticks = static_cast<double>(belief.model.encoder.ticks_per_turn) * k / kCurveSteps;
    const std::optional<double> elevation =
        calib::elevation_rad(belief.model, calib::crank_rad(belief.model.encoder, ticks));
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const CalibrationSurface& surface : belief.surfaces) {
      const std::optional<double> range =
          elevation ? calib::surface_range_m(belief.model.mount, surface, *elevation, 0.0) : std::nullopt;
      if (range) nearest_m = std::min(nearest_m, *range);
    }
    points.emplace_back(ticks, nearest_m);
  }
  return points;
}

/// What both sides share, so that they compare.
struct Scales {
  PlotScale ticks;
  PlotScale range_m;
  PlotScale elevation_deg;
};

Scales scales_of(const std::vector<Dot>& before, const std::vector<Dot>& after, const SweepModel& model) {
  double farthest_m = 0.0;
  double low_deg = 0.0;
  double high_deg = 0.0;
  for (const std::vector<Dot>* dots : {&before, &after}) {
    for (const Dot& dot : *dots) {
      if (!dot.is_used) continue;
      farthest_m = std::max(farthest_m, dot.range_m);
      low_deg = std::min(low_deg, dot.elevation_deg);
      high_deg = std::max(high_deg, dot.elevation_deg);
    }
  }
  return {round_scale(0.0, static_cast<double>(model.encoder.ticks_per_turn)), round_scale(0.0, 1.4 * farthest_m),
          round_scale(low_deg, high_deg)};
}

void draw_ranges(Canvas& canvas, const Belief& belief, const std::vector<Dot>& dots, const Scales& scales,
                 const Point2& corner) {
  ScatterPlot plot(canvas,
                   {.corner = corner,
                    .width = kPanelWidth,
                    .height = kPanelHeight,
                    .x = scales.ticks,
                    .y = scales.range_m,
                    .x_name = "encoder (ticks)",
                    .y_name = "range (m)"},
                   belief.name, "Range of the forward beam over one turn of the crank");
  plot.curve(curve_of(belief), {.colour = ink::kLaser, .width = 3.0});
  for (const Dot& dot : dots) {
    if (dot.is_ahead && dot.is_used) plot.dot(dot.ticks, dot.ahead_m, ink::kRocker, 1.6);
    if (dot.is_ahead)
      plot.dot(dot.ticks, dot.range_m, dot.is_used ? ink::kCoupler : ink::kQuiet, dot.is_used ? 2.2 : 1.5);
  }
  plot.legend(ink::kLaser, true, "modelled");
  plot.legend(ink::kCoupler, false, "measured");
  plot.legend(ink::kRocker, false, "its level part");
}

double scale_of_residuals(const std::vector<Dot>& dots) {
  std::vector<double> sizes;
  for (const Dot& dot : dots) {
    if (dot.is_used && std::isfinite(dot.residual_mm)) sizes.push_back(std::fabs(dot.residual_mm));
  }
  if (sizes.empty()) return 1.0;
  return std::max(1.2 * value_at_share(sizes, kWellInside), 0.1);
}

std::string residual_remark(const std::vector<Dot>& dots) {
  double sum = 0.0;
  double largest = 0.0;
  std::size_t count = 0;
  for (const Dot& dot : dots) {
    if (!dot.is_used || !std::isfinite(dot.residual_mm)) continue;
    sum += dot.residual_mm * dot.residual_mm;
    largest = std::max(largest, std::fabs(dot.residual_mm));
    ++count;
  }
  if (count == 0) return "No measured range meets its surface here";
  return fmt::format("Measured less modelled: RMS {:.3g} mm, largest {:.3g} mm, of {} averages",
                     std::sqrt(sum / static_cast<double>(count)), largest, count);
}

void draw_residuals(Canvas& canvas, const std::vector<Dot>& dots, const Scales& scales, double sigma_mm,
                    const Point2& corner) {
  const double most_mm = scale_of_residuals(dots);
  ScatterPlot plot(canvas,
                   {.corner = corner,
                    .width = kPanelWidth,
                    .height = kPanelHeight,
                    .x = scales.elevation_deg,
                    .y = round_scale(-most_mm, most_mm),
                    .x_name = "elevation (degrees)",
                    .y_name = "residual (mm)"},
                   "Residual over the elevation", residual_remark(dots));
  plot.band(-2.0 * sigma_mm, 2.0 * sigma_mm, ink::kGrid);
  plot.level(0.0, {.colour = ink::kLaser, .width = 2.0});
  for (const Dot& dot : dots) {
    if (dot.is_used && std::isfinite(dot.residual_mm)) plot.dot(dot.elevation_deg, dot.residual_mm, ink::kCoupler, 2.2);
  }
}

double median_sigma_mm(const std::vector<RangeObservation>& observations) {
  std::vector<double> sigmas;
  sigmas.reserve(observations.size());
  for (const RangeObservation& seen : observations) sigmas.push_back(1000.0 * seen.sigma_m);
  if (sigmas.empty()) return 0.0;
  const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
  std::nth_element(sigmas.begin(), middle, sigmas.end());
  return *middle;
}

}  // namespace

Canvas calibration_figure(const CalibrateOutcome& outcome) {
  const Belief before{outcome.start, outcome.start_surfaces, "Before: " + outcome.start.name};
  const Belief after{outcome.result.model, outcome.result.surfaces, "After: calibrated"};
  const std::vector<Dot> dots_before = dots_of(before, outcome);
  const std::vector<Dot> dots_after = dots_of(after, outcome);
  const Scales scales = scales_of(dots_before, dots_after, outcome.start);
  const double sigma_mm = median_sigma_mm(outcome.observations);

  Canvas canvas(kWidth, kHeight, "Calibration: ranges before and after");
  canvas.rectangle({0.0, 0.0}, kWidth, kHeight, Fill{ink::kPage});
  canvas.text({40.0, 52.0}, "Calibration of the nodding mount", {.size = 28.0, .is_bold = true});
  canvas.text(
      {40.0, 82.0},
      fmt::format("{} ranges from {} places of the crank  ·  elevation known to {:.3f}° (RMS)  ·  residual {:.2f} σ"
                  "  ·  grey band: ±2 σ of an average",
                  outcome.statistics.ranges, outcome.statistics.stops, deg_from_rad(outcome.result.elevation_sigma_rad),
                  outcome.result.residual_rms),
      {.size = 15.0, .colour = ink::kQuiet});
  const double right = 40.0 + kPanelWidth + 20.0;
  const double lower = kTop + kPanelHeight + 20.0;
  draw_ranges(canvas, before, dots_before, scales, {40.0, kTop});
  draw_ranges(canvas, after, dots_after, scales, {right, kTop});
  draw_residuals(canvas, dots_before, scales, sigma_mm, {40.0, lower});
  draw_residuals(canvas, dots_after, scales, sigma_mm, {right, lower});
  return canvas;
}

}  // namespace gdtslam
