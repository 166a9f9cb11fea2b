// Elevation and transmission angle over the crank.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "linkage_drawing_parts.hpp"

namespace gdtslam {
namespace {

constexpr int kPlotSteps = 480;
/// Of a tick's step, by which a curve may leave the axis without one more tick.
constexpr double kOvershoot = 0.02;
constexpr double kLeftMargin = 66.0;
constexpr double kRightMargin = 24.0;
constexpr double kTopMargin = 58.0;
constexpr double kBottomMargin = 46.0;

/// A curve's point: degrees of the crank since the lift began, and what is plotted.
struct Sample {
  double crank_deg = 0.0;
  double value_deg = 0.0;
};

struct Scale {
  double from = 0.0;
  double to = 1.0;
  double step = 1.0;
};

/// At most five steps between round angles.
Scale even_scale(double from, double to) {
  Scale scale;
  for (const double step : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0}) {
    scale.step = step;
    if ((to - from) / step <= 5.0) {
      break;
    }
  }
  scale.from = scale.step * std::floor(from / scale.step + kOvershoot);
  scale.to = scale.step * std::ceil(to / scale.step - kOvershoot);
  return scale;
}

class Plot {
 public:
  Plot(Canvas& canvas, const Box& box, double crank_span_deg, const Scale& values)
      : canvas_(canvas), box_(box), crank_span_deg_(crank_span_deg), values_(values) {}

  [[nodiscard]] Point2 at(double crank_deg, double value) const {
    const double width = box_.width - kLeftMargin - kRightMargin;
    const double height = box_.height - kTopMargin - kBottomMargin;
    return box_.corner + Point2(kLeftMargin + width * crank_deg / crank_span_deg_,
                                kTopMargin + height * (values_.to - value) / (values_.to - values_.from));
  }

  void band(double from_deg, double to_deg, Colour fill, const std::string& words) {
    const Point2 corner = at(from_deg, values_.to);
    const Point2 end = at(to_deg, values_.from);
    canvas_.rectangle(corner, end.x() - corner.x(), end.y() - corner.y(), Fill{fill});
    canvas_.text({0.5 * (corner.x() + end.x()), corner.y() - 7.0}, words,
                 {.size = 12.0, .colour = ink::kQuiet, .anchor = Anchor::kMiddle});
  }

  void axes(std::string_view value_name) {
    const int rows = static_cast<int>(std::lround((values_.to - values_.from) / values_.step));
    for (int i = 0; i <= rows; ++i) {
      const double value = values_.from + i * values_.step;
      canvas_.line(at(0.0, value), at(crank_span_deg_, value), {.colour = ink::kGrid});
      canvas_.text(at(0.0, value) + Point2(-8.0, 4.0), fmt::format("{:g}°", value),
                   {.size = 12.0, .colour = ink::kQuiet, .anchor = Anchor::kEnd});
    }
    const Scale crank = even_scale(0.0, crank_span_deg_);
    for (double tick = 0.0; tick <= crank_span_deg_ + 1e-6; tick += crank.step) {
      canvas_.line(at(tick, values_.from), at(tick, values_.from) + Point2(0.0, 4.0), {.colour = ink::kQuiet});
      canvas_.text(at(tick, values_.from) + Point2(0.0, 18.0), fmt::format("{:g}°", tick),
                   {.size = 12.0, .colour = ink::kQuiet, .anchor = Anchor::kMiddle});
    }
    canvas_.line(at(0.0, values_.from), at(crank_span_deg_, values_.from), {.colour = ink::kQuiet});
    canvas_.upright_text({box_.corner.x() + 16.0, 0.5 * (at(0.0, values_.from).y() + at(0.0, values_.to).y())},
                         value_name, {.size = 12.0, .colour = ink::kQuiet, .anchor = Anchor::kMiddle});
  }

  void crank_name(std::string_view words) {
    canvas_.text(at(0.5 * crank_span_deg_, values_.from) + Point2(0.0, 36.0), words,
                 {.size = 12.0, .colour = ink::kQuiet, .anchor = Anchor::kMiddle});
  }

  void curve(const std::vector<Sample>& samples, Colour colour) {
    std::vector<Point2> points;
    points.reserve(samples.size());
    for (const Sample& sample : samples) {
      points.push_back(at(sample.crank_deg, sample.value_deg));
    }
    canvas_.polyline(points, {.colour = colour, .width = 2.5});
  }

  void dot(const Sample& sample, Colour colour) {
    canvas_.circle(at(sample.crank_deg, sample.value_deg), 5.0, Fill{ink::kCard}, Pen{.colour = colour, .width = 2.5});
  }

 private:
  Canvas& canvas_;
  Box box_;
  double crank_span_deg_;
  Scale values_;
};

double since_begin_deg(const LinkageSummary& summary, double crank_rad) {
  return deg_from_rad(std::fabs(crank_rad - summary.from_rad));
}

// Without the jumps by whole turns.
std::vector<Sample> elevations_of(const LinkageSummary& summary) {
  std::vector<Sample> samples;
  double last_rad = 0.0;
  for (const LinkageRow& row : rows_of(summary, kPlotSteps)) {
    const double elevation_rad =
        samples.empty() ? row.elevation_rad : last_rad + wrap_angle(row.elevation_rad - last_rad);
    samples.push_back({since_begin_deg(summary, row.crank_rad), deg_from_rad(elevation_rad)});
    last_rad = elevation_rad;
  }
  return samples;
}

Sample nearest(const std::vector<Sample>& samples, double crank_deg) {
  return *std::min_element(samples.begin(), samples.end(), [crank_deg](const Sample& a, const Sample& b) {
    return std::fabs(a.crank_deg - crank_deg) < std::fabs(b.crank_deg - crank_deg);
  });
}

bool is_lower(const Sample& a, const Sample& b) { return a.value_deg < b.value_deg; }

void draw_strokes(Plot& plot, const LinkageSummary& summary) {
  if (!summary.report) {
    return;
  }
  const double lift_deg = deg_from_rad(std::fabs(lift_span_rad(summary)));
  plot.band(0.0, lift_deg, colour_for(0xeef5f2), fmt::format("lift {:.1f}°", lift_deg));
  plot.band(lift_deg, 360.0, colour_for(0xfbf1ec), fmt::format("return {:.1f}°", 360.0 - lift_deg));
}

}  // namespace

void draw_elevation(Canvas& canvas, const LinkageSummary& summary, double shown_rad, const Box& box) {
  const std::vector<Sample> samples = elevations_of(summary);
  const auto [low, high] = std::minmax_element(samples.begin(), samples.end(), is_lower);
  Plot plot(canvas, box, deg_from_rad(std::fabs(summary.span_rad)), even_scale(low->value_deg, high->value_deg));
  draw_strokes(plot, summary);
  plot.axes("elevation");
  plot.curve(samples, ink::kLaser);
  plot.dot(nearest(samples, since_begin_deg(summary, shown_rad)), ink::kLaser);
  plot.crank_name(summary.report ? "crank since the lift began" : "crank within the stretch that closes");
}

void draw_transmission(Canvas& canvas, const LinkageSummary& summary, double shown_rad, const Box& box) {
  std::vector<Sample> samples;
  for (const LinkageRow& row : rows_of(summary, kPlotSteps)) {
    samples.push_back({since_begin_deg(summary, row.crank_rad), deg_from_rad(row.pose.transmission_rad)});
  }
  const double span_deg = deg_from_rad(std::fabs(summary.span_rad));
  Plot plot(canvas, box, span_deg, {.from = 0.0, .to = 90.0, .step = 30.0});
  const double poor_deg = deg_from_rad(calib::kPoorTransmission_rad);
  const Point2 corner = plot.at(0.0, poor_deg);
  const Point2 end = plot.at(span_deg, 0.0);
  canvas.rectangle(corner, end.x() - corner.x(), end.y() - corner.y(), Fill{colour_for(0xfbeceb)});
  plot.axes("transmission");
  canvas.line(corner, plot.at(span_deg, poor_deg), {.colour = ink::kWarning, .width = 1.2, .dashes = "5 4"});
  canvas.text(box.corner + Point2(box.width - kRightMargin, 28.0), fmt::format("shaded: below {:.0f}°, poor", poor_deg),
              {.size = 12.0, .colour = ink::kWarning, .anchor = Anchor::kEnd});
  plot.curve(samples, ink::kCoupler);
  plot.dot(nearest(samples, since_begin_deg(summary, shown_rad)), ink::kCoupler);
  const Sample least = *std::min_element(samples.begin(), samples.end(), is_lower);
  canvas.circle(plot.at(least.crank_deg, least.value_deg), 4.0, Fill{ink::kWarning},
                Pen{.colour = ink::kCard, .width = 1.0});
  const bool is_left = least.crank_deg < 0.5 * span_deg;
  canvas.text(plot.at(least.crank_deg, least.value_deg) + Point2(is_left ? 10.0 : -10.0, -8.0),
              fmt::format("least {:.1f}°", least.value_deg),
              {.size = 12.0, .anchor = is_left ? Anchor::kStart : Anchor::kEnd, .is_bold = true, .has_halo = true});
  plot.crank_name(summary.report ? "crank since the lift began" : "crank within the stretch that closes");
}

}  // namespace gdtslam
