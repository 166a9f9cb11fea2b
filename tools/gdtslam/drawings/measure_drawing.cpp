#include "measure_drawing.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "engine/drawing/plots/bars.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam {
namespace {

constexpr double kWidth = 1280.0;
constexpr double kHeight = 800.0;
constexpr double kRadius = 10.0;
constexpr double kMargin_m = 0.4;  // around the boxes and the viewpoint
constexpr double kLeastView_m = 1.5;
constexpr double kAside_px = 30.0;  // distance of a dimension line from its edge
constexpr double kTick_px = 6.0;
constexpr double kGrid_px = 120.0;  // widest square of the grid, and longest scale bar
constexpr int kDotsAcross = 170;    // squares across the view, each with one dot for its points
constexpr std::array kFills{ink::kCoupler, ink::kRocker, ink::kCrank, ink::kCurve};
constexpr std::size_t kMostRows = 4;  // boxes in the table

/// From the map's plane to the page: x up, y to the left.
struct TopView {
  DrawingArea card;
  Point2 centre_m = Point2::Zero();
  double pixels_per_m = 100.0;
  [[nodiscard]] Point2 at(double x_m, double y_m) const {
    const Point2 middle = card.corner + Point2(0.5 * card.width, 0.5 * card.height);
    return middle + pixels_per_m * Point2(centre_m.y() - y_m, centre_m.x() - x_m);
  }
  [[nodiscard]] bool shows(const Point2& at, double margin) const {
    return at.x() >= card.corner.x() + margin && at.x() <= card.corner.x() + card.width - margin &&
           at.y() >= card.corner.y() + margin && at.y() <= card.corner.y() + card.height - margin;
  }
};

/// Corners of a box on the floor: the two ends of the face, then those at the back.
struct Outline {
  Point2 left;
  Point2 right;
  Point2 back_right;
  Point2 back_left;
  Point2 out;  ///< normal of the face, a unit vector of the map
  bool has_depth = false;
};

Outline box_outline(const MeasuredBox& box) {
  Outline outline;
  const Point2 normal(box.face_normal.x(), box.face_normal.y());
  outline.out = normal.normalized();
  const Point2 across(-outline.out.y(), outline.out.x());
  outline.has_depth = std::isfinite(box.depth.sigma_m);
  const double depth_m = outline.has_depth ? box.depth.value_m : 0.5 * box.width.value_m;
  const Point2 centre(box.centre.x(), box.centre.y());
  const Point2 face = centre + 0.5 * box.depth.value_m * outline.out;
  outline.left = face - 0.5 * box.width.value_m * across;
  outline.right = face + 0.5 * box.width.value_m * across;
  outline.back_left = outline.left - depth_m * outline.out;
  outline.back_right = outline.right - depth_m * outline.out;
  return outline;
}

std::vector<Point2> box_corners(const Outline& outline) {
  return {outline.left, outline.right, outline.back_right, outline.back_left};
}

TopView top_view(const Measurement& measured, std::span<const CloudPoint> cloud, const DrawingArea& card) {
  Eigen::AlignedBox2d shown;
  for (const MeasuredBox& box : measured.boxes) {
    for (const Point2& corner : box_corners(box_outline(box))) shown.extend(corner);
  }
  if (measured.viewpoint) shown.extend(Point2(measured.viewpoint->head<2>()));
  if (measured.boxes.empty()) {
    for (const CloudPoint& point : cloud) shown.extend(Point2(point.x_m, point.y_m));
  }
  const Point2 size = shown.sizes();
  TopView view{card, shown.center(), 0.0};
  const double tall_m = std::max(kLeastView_m, size.x() + 2.0 * kMargin_m);
  const double wide_m = std::max(kLeastView_m, size.y() + 3.0 * kMargin_m);
  view.pixels_per_m = std::min(card.width / wide_m, card.height / tall_m);
  return view;
}

// One dot per square with points between the floor and the top of the highest box; fainter if there are few.
void draw_points(Canvas& canvas, const Measurement& measured, std::span<const CloudPoint> cloud, const TopView& view) {
  double low_m = -1e9;
  double high_m = 1e9;
  if (!measured.boxes.empty()) {
    low_m = 1e9;
    high_m = -1e9;
    for (const MeasuredBox& box : measured.boxes) {
      low_m = std::min(low_m, box.centre.z() - 0.45 * box.height.value_m);
      high_m = std::max(high_m, box.centre.z() + 0.55 * box.height.value_m);
    }
  }
  const double square_px = view.card.width / kDotsAcross;
  std::vector<std::pair<int, int>> squares;
  for (const CloudPoint& point : cloud) {
    const auto z_m = static_cast<double>(point.z_m);
    if (z_m < low_m || z_m > high_m) continue;
    const Point2 at = view.at(static_cast<double>(point.x_m), static_cast<double>(point.y_m));
    if (!view.shows(at, 4.0)) continue;
    squares.emplace_back(static_cast<int>(at.x() / square_px), static_cast<int>(at.y() / square_px));
  }
  std::sort(squares.begin(), squares.end());
  for (std::size_t k = 0; k < squares.size();) {
    std::size_t end = k;
    while (end < squares.size() && squares[end] == squares[k]) ++end;
    const double share = std::min(1.0, 0.25 + static_cast<double>(end - k) / 40.0);
    const Point2 at(square_px * (squares[k].first + 0.5), square_px * (squares[k].second + 0.5));
    canvas.circle(at, 0.36 * square_px * share, Fill{colour_for(0xb9b4a6)});
    k = end;
  }
}

// A line beside the measured edge with ticks at both ends, and the value at its middle.
void draw_dimension(Canvas& canvas, const TopView& view, const Point2& from_m, const Point2& to_m, const Point2& out_m,
                    const Dimension& dimension, Colour colour) {
  const Point2 out(-out_m.y(), -out_m.x());
  const Point2 from = view.at(from_m.x(), from_m.y()) + kAside_px * out;
  const Point2 to = view.at(to_m.x(), to_m.y()) + kAside_px * out;
  const Pen pen{.colour = colour, .width = 1.5, .dashes = dimension.is_observed ? "" : "4 4"};
  for (const Point2& end : {from, to}) {
    canvas.line(end - (kAside_px - 5.0) * out, end + kTick_px * out, {.colour = colour, .width = 1.0, .opacity = 0.55});
  }
  canvas.line(from, to, pen);
  const Point2 label = 0.5 * (from + to) + 20.0 * out;
  const Anchor anchor = out.x() > 0.5 ? Anchor::kStart : out.x() < -0.5 ? Anchor::kEnd : Anchor::kMiddle;
  canvas.text(label + Point2(0.0, 5.0), fmt::format("{:.2f} cm", 100.0 * dimension.value_m),
              {.size = 15.0, .colour = colour, .anchor = anchor, .is_bold = true, .has_halo = true});
}

void draw_box(Canvas& canvas, const TopView& view, const MeasuredBox& box, std::size_t number) {
  const Colour colour = kFills[number % kFills.size()];
  const Outline outline = box_outline(box);
  std::vector<Point2> corners;
  for (const Point2& corner : box_corners(outline)) corners.push_back(view.at(corner.x(), corner.y()));
  canvas.polygon(corners, Fill{colour, outline.has_depth ? 0.16 : 0.08});
  const std::string_view dashes = outline.has_depth ? "" : "5 5";
  canvas.polyline({corners[1], corners[2], corners[3], corners[0]}, {.colour = colour, .width = 1.5, .dashes = dashes});
  canvas.line(corners[0], corners[1], {.colour = colour, .width = 4.0});
  const Point2 middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  canvas.text(middle + Point2(0.0, 6.0), fmt::format("{}", number + 1),
              {.size = 18.0, .colour = colour, .anchor = Anchor::kMiddle, .is_bold = true, .has_halo = true});
  draw_dimension(canvas, view, outline.left, outline.right, outline.out, box.width, colour);
  if (!outline.has_depth) return;
  const Point2 across(-outline.out.y(), outline.out.x());
  const bool is_left_out = across.y() < 0.0;  // beside the box on the right of the page
  const Point2 side = is_left_out ? across : Point2(-across);
  const Point2& front = is_left_out ? outline.right : outline.left;
  const Point2& back = is_left_out ? outline.back_right : outline.back_left;
  draw_dimension(canvas, view, front, back, side, box.depth, colour);
}

void draw_scanner(Canvas& canvas, const TopView& view, const Point3& viewpoint) {
  const Point2 at = view.at(viewpoint.x(), viewpoint.y());
  canvas.circle(at, 16.0, std::nullopt, Pen{.colour = ink::kLaser, .width = 1.0, .opacity = 0.5});
  canvas.circle(at, 7.0, Fill{ink::kLaser}, Pen{.colour = colour_for(0xffffff), .width = 2.0});
  canvas.text(at + Point2(24.0, 5.0), "scanner", {.size = 13.0, .colour = ink::kQuiet, .has_halo = true});
}

void draw_row(Canvas& canvas, const Point2& at, std::string_view name, const Dimension& dimension) {
  const bool is_known = std::isfinite(dimension.sigma_m);
  canvas.text(at, name, {.size = 13.0, .colour = ink::kQuiet});
  const std::string value = is_known ? fmt::format("{:.2f}", 100.0 * dimension.value_m) : "not seen";
  const Colour colour = is_known ? ink::kText : ink::kQuiet;
  canvas.text(at + Point2(142.0, 0.0), value,
              {.size = 16.0, .colour = colour, .anchor = Anchor::kEnd, .is_bold = is_known});
  if (!is_known) return;
  canvas.text(at + Point2(150.0, 0.0), fmt::format("± {:.2f} cm", 100.0 * dimension.sigma_m), {.size = 13.0});
  if (!dimension.is_observed) {
    canvas.text(at + Point2(238.0, 0.0), "an end not seen", {.size = 12.0, .colour = ink::kWarning});
  }
}

void draw_table(Canvas& canvas, const Measurement& measured, const DrawingArea& card) {
  double y = card.corner.y() + 66.0;
  const double x = card.corner.x() + 20.0;
  const std::size_t shown = std::min(measured.boxes.size(), kMostRows);
  for (std::size_t k = 0; k < shown; ++k) {
    const MeasuredBox& box = measured.boxes[k];
    const Colour colour = kFills[k % kFills.size()];
    canvas.circle({x + 10.0, y - 5.0}, 11.0, Fill{colour}, Pen{.colour = colour});
    canvas.text({x + 10.0, y}, fmt::format("{}", k + 1),
                {.size = 14.0, .colour = colour_for(0xffffff), .anchor = Anchor::kMiddle, .is_bold = true});
    draw_row(canvas, {x + 36.0, y}, "width", box.width);
    draw_row(canvas, {x + 36.0, y + 26.0}, "depth", box.depth);
    draw_row(canvas, {x + 36.0, y + 52.0}, "height", box.height);
    canvas.text({x + 36.0, y + 78.0}, fmt::format("face: {} points, {:.1f} mm rms", box.points, 1e3 * box.face_rms_m),
                {.size = 12.0, .colour = ink::kQuiet});
    y += 124.0;
    if (k + 1 < shown)
      canvas.line({x, y - 32.0}, {card.corner.x() + card.width - 20.0, y - 32.0}, {.colour = ink::kGrid});
  }
  if (measured.boxes.size() > shown) {
    canvas.text({x, y}, fmt::format("and {} more", measured.boxes.size() - shown),
                {.size = 13.0, .colour = ink::kQuiet});
  }
  if (measured.boxes.empty()) canvas.text({x, y}, "No box was found.", {.size = 14.0, .colour = ink::kQuiet});
}

}  // namespace

Canvas draw_measurement(const Measurement& measured, std::span<const CloudPoint> cloud) {
  Canvas canvas(kWidth, kHeight, "Boxes of " + measured.cloud);
  canvas.rectangle({0.0, 0.0}, kWidth, kHeight, Fill{ink::kPage});
  const std::size_t count = measured.boxes.size();
  canvas.text({40.0, 52.0}, fmt::format("{} {}", count, count == 1 ? "box" : "boxes"), {.size = 28.0, .is_bold = true});
  canvas.text({40.0, 80.0}, fmt::format("{}  ·  {} points", measured.cloud, measured.points),
              {.size = 15.0, .colour = ink::kQuiet});
  const DrawingArea plan{{40.0, 104.0}, 760.0, 656.0};
  const DrawingArea table{{820.0, 104.0}, 420.0, 656.0};
  for (const DrawingArea& card : {plan, table}) {
    canvas.rectangle(card.corner, card.width, card.height, Fill{ink::kCard}, Pen{.colour = ink::kEdge}, kRadius);
  }
  const TopView view = top_view(measured, cloud, plan);
  draw_grid(canvas, plan, view.at(0.0, 0.0), round_length_m(kGrid_px / view.pixels_per_m) * view.pixels_per_m);
  draw_points(canvas, measured, cloud, view);
  for (std::size_t k = 0; k < count; ++k) draw_box(canvas, view, measured.boxes[k], k);
  if (measured.viewpoint) draw_scanner(canvas, view, *measured.viewpoint);
  draw_scale_bar(canvas, {.pixels_per_m = view.pixels_per_m, .most = kGrid_px, .text_size = 12.0},
                 plan.corner + Point2(24.0, plan.height - 24.0));
  canvas.text(plan.corner + Point2(20.0, 28.0), "From above", {.size = 15.0, .is_bold = true, .has_halo = true});
  canvas.text(table.corner + Point2(20.0, 28.0), "Dimensions", {.size = 15.0, .is_bold = true});
  draw_table(canvas, measured, table);
  return canvas;
}

}  // namespace gdtslam
