// The figure of a calibration.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "calib/calibration/calibration_residual.hpp"
#include "engine/core/elementary.hpp"
#include "engine/core/quantile.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/drawing/plot.hpp"
#include "run.hpp"

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

/// The axes that both sides share, so that they compare.
struct Axes {
  Axis ticks;
  Axis range_m;
  Axis elevation_deg;
};

Axes axes_of(const std::vector<Dot>& before, const std::vector<Dot>& after, const SweepModel& model) {
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
  const auto axis = [](const char* title, double from, double to) {
    return Axis{.title = title, .from = from, .to = std::max(to, from + 1e-9), .is_grown = true};
  };
  return {axis("encoder (ticks)", 0.0, static_cast<double>(model.encoder.ticks_per_turn)),
          axis("range (m)", 0.0, 1.4 * farthest_m), axis("elevation (degrees)", low_deg, high_deg)};
}

// A card with a heading and the axes of a plot.
Plot plot_on_card(Canvas& canvas, const Point2& corner, std::string_view heading, std::string_view remark,
                  const Axis& x, const Axis& y) {
  canvas.rectangle(corner, kPanelWidth, kPanelHeight, Fill{ink::kCard}, Pen{.colour = ink::kEdge}, 10.0);
  canvas.text(corner + Point2(20.0, 28.0), heading, {.size = 15.0, .is_bold = true});
  canvas.text(corner + Point2(20.0, 48.0), remark, {.size = 12.0, .colour = ink::kQuiet});
  const DrawingArea area{corner + Point2(14.0, 62.0), kPanelWidth - 34.0, kPanelHeight - 76.0};
  return {canvas, area, x, y, {.text_size = 12.0, .has_frame = false}};
}

void draw_ranges(Canvas& canvas, const Belief& belief, const std::vector<Dot>& dots, const Axes& axes,
                 const Point2& corner) {
  Plot plot = plot_on_card(canvas, corner, belief.name, "Range of the forward beam over one turn of the crank",
                           axes.ticks, axes.range_m);
  std::vector<Point2> unused;
  std::vector<Point2> measured;
  std::vector<Point2> level;
  for (const Dot& dot : dots) {
    if (!dot.is_ahead) continue;
    (dot.is_used ? measured : unused).emplace_back(dot.ticks, dot.range_m);
    if (dot.is_used) level.emplace_back(dot.ticks, dot.ahead_m);
  }
  plot.line(curve_of(belief), {.colour = ink::kLaser, .width = 3.0}, "modelled");
  plot.markers(unused, Fill{ink::kQuiet}, 1.5);
  plot.markers(measured, Fill{ink::kCoupler}, 2.2, "measured");
  plot.markers(level, Fill{ink::kRocker}, 1.6, "its level part");
  plot.legend();
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

void draw_residuals(Canvas& canvas, const std::vector<Dot>& dots, const Axes& axes, double sigma_mm,
                    const Point2& corner) {
  const double most_mm = scale_of_residuals(dots);
  Plot plot = plot_on_card(canvas, corner, "Residual over the elevation", residual_remark(dots), axes.elevation_deg,
                           {.title = "Residual (mm)", .from = -most_mm, .to = most_mm, .is_grown = true});
  const auto across = [](double mm) { return std::array{Point2(-180.0, mm), Point2(180.0, mm)}; };
  plot.band(across(-2.0 * sigma_mm), across(2.0 * sigma_mm), Fill{ink::kGrid});
  plot.level(0.0, {.colour = ink::kLaser, .width = 2.0});
  std::vector<Point2> residuals;
  for (const Dot& dot : dots) {
    if (dot.is_used) residuals.emplace_back(dot.elevation_deg, dot.residual_mm);
  }
  plot.markers(residuals, Fill{ink::kCoupler}, 2.2);
}

double median_sigma_mm(const std::vector<RangeObservation>& observations) {
  std::vector<double> sigmas;
  sigmas.reserve(observations.size());
  for (const RangeObservation& seen : observations) sigmas.push_back(1000.0 * seen.sigma_m);
  return sigmas.empty() ? 0.0 : upper_median(sigmas);
}

}  // namespace

Canvas calibration_figure(const CalibrateOutcome& outcome) {
  const Belief before{outcome.start, outcome.start_surfaces, "Before: " + outcome.start.name};
  const Belief after{outcome.result.model, outcome.result.surfaces, "After: calibrated"};
  const std::vector<Dot> dots_before = dots_of(before, outcome);
  const std::vector<Dot> dots_after = dots_of(after, outcome);
  const Axes axes = axes_of(dots_before, dots_after, outcome.start);
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
  draw_ranges(canvas, before, dots_before, axes, {40.0, kTop});
  draw_ranges(canvas, after, dots_after, axes, {right, kTop});
  draw_residuals(canvas, dots_before, axes, sigma_mm, {40.0, lower});
  draw_residuals(canvas, dots_after, axes, sigma_mm, {right, lower});
  return canvas;
}

}  // namespace gdtslam
