// The figure of a calibration.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "calib/calibration/calibration_residual.hpp"
#include "calibrate.hpp"
#include "engine/core/elementary.hpp"
#include "engine/core/quantile.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/drawing/plot.hpp"

namespace gdtslam {
namespace {

using calib::CalibrationSurface;
using calib::RangeObservation;
using calib::SweepModel;

constexpr double kFigureWidth = 1280.0;
constexpr double kFigureHeight = 900.0;
constexpr double kFigureMargin = 40.0;
constexpr double kPlotHeight = 380.0;
constexpr int kCurveSteps = 1000;
constexpr std::size_t kMostDots = 1500;  // in a plot, an even sample
constexpr double kWellInside = 0.98;     // share of the residuals within the scale
constexpr Colour kBefore = ink::kLaser;
constexpr Colour kAfter = ink::kCoupler;

/// The scanner's model before or after the calibration.
struct Belief {
  const SweepModel& model;
  const std::vector<CalibrationSurface>& surfaces;
};

double least_bearing(const std::vector<RangeObservation>& observations) {
  double least = kPi;
  for (const RangeObservation& seen : observations) least = std::min(least, std::fabs(seen.bearing_rad));
  return least;
}

/// Elevation in degrees, and measured minus modelled range in millimetres, of the observations used.
std::vector<Point2> compute_residuals(const Belief& belief, const CalibrateOutcome& outcome) {
  std::vector<Point2> residuals;
  const std::size_t step = 1 + outcome.observations.size() / kMostDots;
  for (std::size_t k = 0; k < outcome.observations.size(); k += step) {
    const RangeObservation& seen = outcome.observations[k];
    const std::optional<double> elevation =
        calib::elevation_rad(belief.model, calib::crank_rad(belief.model.encoder, seen.ticks));
    if (!elevation) continue;
    const CalibrationSurface& surface = belief.surfaces[seen.surface];
    const double used = calib::measured_elevation_rad(belief.model.mount, surface, seen, *elevation);
    const std::optional<double> range_m =
        calib::surface_range_m(belief.model.mount, surface, *elevation, seen.bearing_rad);
    if (!range_m || std::fabs(used) > outcome.max_elevation_rad) continue;
    residuals.emplace_back(deg_from_rad(*elevation), 1000.0 * (seen.range_m - *range_m));
  }
  return residuals;
}

/// Range of the forward beam over a turn.
std::vector<Point2> range_curve(const Belief& belief) {
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

// Draws a card and returns its plot.
Plot plot_on_card(Canvas& canvas, double top, const std::string& title, const Axis& x, const Axis& y) {
  const double width = kFigureWidth - 2.0 * kFigureMargin;
  canvas.rectangle({kFigureMargin, top}, width, kPlotHeight, Fill{ink::kCard}, Pen{.colour = ink::kEdge}, 10.0);
  const DrawingArea area{{kFigureMargin + 14.0, top + 8.0}, width - 34.0, kPlotHeight - 20.0};
  return {canvas, area, x, y, {.title = title, .text_size = 14.0, .has_frame = false}};
}

void draw_ranges(Canvas& canvas, const Belief& before, const Belief& after, const CalibrateOutcome& outcome,
                 double top) {
  const double ahead_rad = least_bearing(outcome.observations) + 1e-9;
  std::vector<Point2> measured;
  double farthest_m = 0.0;
  for (const RangeObservation& seen : outcome.observations) {
    if (std::fabs(seen.bearing_rad) > ahead_rad) continue;
    measured.emplace_back(seen.ticks, seen.range_m);
    farthest_m = std::max(farthest_m, seen.range_m);
  }
  Plot plot =
      plot_on_card(canvas, top, "Range of the forward beam over one turn of the crank",
                   {.title = "encoder (ticks)", .to = static_cast<double>(outcome.start.encoder.ticks_per_turn)},
                   {.title = "range (m)", .to = std::max(1.1 * farthest_m, 1e-9), .is_grown = true});
  plot.line(range_curve(before), {.colour = kBefore, .width = 2.0, .dashes = "6 4"}, "modelled before");
  plot.line(range_curve(after), {.colour = kBefore, .width = 3.0}, "modelled after");
  plot.markers(measured, Fill{kAfter}, 2.2, "measured");
  plot.legend();
}

double median_sigma_mm(const std::vector<RangeObservation>& observations) {
  std::vector<double> sigmas;
  sigmas.reserve(observations.size());
  for (const RangeObservation& seen : observations) sigmas.push_back(1000.0 * seen.sigma_m);
  return sigmas.empty() ? 0.0 : upper_median(sigmas);
}

std::string rms_text(const char* name, const std::vector<Point2>& residuals) {
  double sum = 0.0;
  for (const Point2& residual : residuals) sum += residual.y() * residual.y();
  return residuals.empty()
             ? std::string(name)
             : fmt::format("{}: RMS {:.3g} mm", name, std::sqrt(sum / static_cast<double>(residuals.size())));
}

void draw_residuals(Canvas& canvas, const Belief& before, const Belief& after, const CalibrateOutcome& outcome,
                    double top) {
  const std::vector<Point2> old_ones = compute_residuals(before, outcome);
  const std::vector<Point2> new_ones = compute_residuals(after, outcome);
  std::vector<double> sizes{0.1};
  double low_deg = 0.0;
  double high_deg = 0.0;
  for (const std::vector<Point2>* residuals : {&old_ones, &new_ones}) {
    for (const Point2& residual : *residuals) {
      sizes.push_back(std::fabs(residual.y()));
      low_deg = std::min(low_deg, residual.x());
      high_deg = std::max(high_deg, residual.x());
    }
  }
  const double most_mm = 1.2 * value_at_share(sizes, kWellInside);
  const double sigma_mm = median_sigma_mm(outcome.observations);
  Plot plot = plot_on_card(canvas, top, "Measured less modelled range over the elevation",
                           {.title = "elevation (degrees)", .from = low_deg, .to = high_deg, .is_grown = true},
                           {.title = "residual (mm)", .from = -most_mm, .to = most_mm, .is_grown = true});
  const auto across = [](double mm) { return std::array{Point2(-180.0, mm), Point2(180.0, mm)}; };
  plot.band(across(-2.0 * sigma_mm), across(2.0 * sigma_mm), Fill{ink::kGrid}, "±2 σ of an average");
  plot.level(0.0, {.colour = ink::kQuiet, .width = 1.0});
  plot.markers(old_ones, Fill{kBefore, 0.6}, 2.2, rms_text("before", old_ones));
  plot.markers(new_ones, Fill{kAfter}, 2.2, rms_text("after", new_ones));
  plot.legend();
}

}  // namespace

Canvas calibration_figure(const CalibrateOutcome& outcome) {
  const Belief before{outcome.start, outcome.start_surfaces};
  const Belief after{outcome.result.model, outcome.result.surfaces};
  Canvas canvas(kFigureWidth, kFigureHeight, "Calibration: ranges before and after");
  canvas.rectangle({0.0, 0.0}, kFigureWidth, kFigureHeight, Fill{ink::kPage});
  canvas.text({kFigureMargin, 46.0}, "Calibration of the nodding mount", {.size = 26.0, .is_bold = true});
  canvas.text({kFigureMargin, 74.0},
              fmt::format("started from {}  ·  {} ranges from {} places of the crank  ·  elevation known to {:.3f}° "
                          "(RMS)  ·  residual {:.2f} σ",
                          outcome.start.name, outcome.statistics.ranges, outcome.statistics.stops,
                          deg_from_rad(outcome.result.elevation_sigma_rad), outcome.result.residual_rms),
              {.size = 15.0, .colour = ink::kQuiet});
  draw_ranges(canvas, before, after, outcome, 94.0);
  draw_residuals(canvas, before, after, outcome, 94.0 + kPlotHeight + 16.0);
  return canvas;
}

}  // namespace gdtslam
