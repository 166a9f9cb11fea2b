#include "linkage_drawing.hpp"

#include <fmt/format.h>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "linkage_drawing_parts.hpp"

namespace gdtslam {
namespace {

constexpr double kWidth = 1280.0;
constexpr double kHeight = 800.0;
constexpr double kRadius = 10.0;

void draw_card(Canvas& canvas, const Box& box, std::string_view heading) {
  canvas.rectangle(box.corner, box.width, box.height, Fill{ink::kCard}, Pen{.colour = ink::kEdge}, kRadius);
  canvas.text(box.corner + Point2(20.0, 28.0), heading, {.size = 15.0, .is_bold = true});
}

void draw_header(Canvas& canvas, const LinkageSummary& summary) {
  canvas.text({40.0, 52.0}, summary.model.name, {.size = 28.0, .is_bold = true});
  canvas.text({40.0, 80.0},
              fmt::format("{}  ·  {}  ·  {} assembly", calib::class_name(summary.grashof),
                          calib::inequality_text(summary.model.bars),
                          summary.model.assembly == calib::Assembly::kOpen ? "open" : "crossed"),
              {.size = 15.0, .colour = ink::kQuiet});
}

struct Figure {
  std::string value;
  std::string meaning;
  Colour colour = ink::kText;
};

std::vector<Figure> figures_of(const LinkageSummary& summary) {
  const calib::FreudensteinCoefficients k = calib::freudenstein(summary.model.bars);
  const Figure coefficients{fmt::format("{:.3f}  {:.3f}  {:.3f}", k.k1, k.k2, k.k3), "Freudenstein K1, K2, K3"};
  if (!summary.report) {
    return {{fmt::format("{:.1f}°", deg_from_rad(summary.span_rad)), "of the crank's turn"}, coefficients};
  }
  const calib::CrankRockerReport& report = *summary.report;
  const bool is_poor = report.least_transmission_rad < calib::kPoorTransmission_rad;
  return {{fmt::format("{:.1f}°", deg_from_rad(report.swing_rad)), "swing of the laser"},
          {fmt::format("{:.1f}°", 360.0 * report.lift_share), "of the turn lift"},
          {fmt::format("{:.2f}", report.time_ratio), "lift over return"},
          {fmt::format("{:.1f}°", deg_from_rad(report.least_transmission_rad)), "least transmission",
           is_poor ? ink::kWarning : ink::kText},
          {fmt::format("{:.2f}", report.most_rocker_rate), "most rocker per crank"},
          coefficients};
}

void draw_figures(Canvas& canvas, const LinkageSummary& summary, const Box& box) {
  constexpr double kColumns[] = {20.0, 168.0, 316.0};
  const std::vector<Figure> figures = figures_of(summary);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const std::size_t row = i / 3;
    const Point2 at = box.corner + Point2(kColumns[i % 3], 66.0 + 58.0 * static_cast<double>(row));
    const bool is_long = figures[i].value.size() > 12;
    canvas.text(at, figures[i].value, {.size = is_long ? 14.0 : 22.0, .colour = figures[i].colour, .is_bold = true});
    canvas.text(at + Point2(0.0, 19.0), figures[i].meaning, {.size = 12.0, .colour = ink::kQuiet});
  }
}

}  // namespace

Canvas drawing_of(const LinkageSummary& summary) {
  Canvas canvas(kWidth, kHeight, "Linkage " + summary.model.name);
  canvas.rectangle({0.0, 0.0}, kWidth, kHeight, Fill{ink::kPage});
  const Box positions{{40.0, 104.0}, 700.0, 656.0};
  const Box elevation{{760.0, 104.0}, 480.0, 252.0};
  const Box transmission{{760.0, 372.0}, 480.0, 212.0};
  const Box figures{{760.0, 600.0}, 480.0, 160.0};
  draw_header(canvas, summary);
  draw_card(canvas, positions, summary.report ? "Positions over the lift, the crank turning evenly" : "Positions");
  draw_card(canvas, elevation, "Elevation of the laser");
  draw_card(canvas, transmission, "Transmission angle");
  draw_card(canvas, figures, "In figures");
  const double shown_rad = shown_crank_rad(summary);
  draw_positions(canvas, summary, shown_rad, positions);
  draw_elevation(canvas, summary, shown_rad, elevation);
  draw_transmission(canvas, summary, shown_rad, transmission);
  draw_figures(canvas, summary, figures);
  return canvas;
}

}  // namespace gdtslam
