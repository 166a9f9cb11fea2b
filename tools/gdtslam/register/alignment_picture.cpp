#include "alignment_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "engine/core/quantile.hpp"
#include "engine/core/to_position.hpp"
#include "engine/drawing/letters.hpp"
#include "engine/drawing/plots/bars.hpp"
#include "gdtslam/cloud/thinning.hpp"

namespace gdtslam {
namespace {

constexpr double kMargin = 40.0;
constexpr double kColumn = 620.0;  // width of a panel and its greatest height
constexpr double kTop = 176.0;     // above the panels
constexpr double kBorder = 30.0;   // around the clouds in a panel
constexpr double kWidth = 2.0 * (kMargin + kColumn) + 0.5 * kMargin;
constexpr double kLongestBar = 130.0;
constexpr int kDensity = 2;             // cells of a panel per pixel of the drawing, as in its PNG
constexpr double kStrayShare = 0.005;   // of the points, at either end of an axis
constexpr std::size_t kSample = 50000;  // points that give the size of a cloud
constexpr double kFaintest = 0.45;
constexpr std::array kInks{ink::kCoupler, colour_for(0xe8750a), ink::kText};  // of a, b and both

Eigen::AlignedBox3d find_bulk(std::span<const CloudPoint> cloud, const Pose3& T) {
  Eigen::AlignedBox3d box;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    for (std::size_t k = 0; k < cloud.size(); k += 1 + cloud.size() / kSample) {
      along.push_back((T * to_position(cloud[k]))[axis]);
    }
    box.min()[axis] = value_at_share(along, kStrayShare);
    box.max()[axis] = value_at_share(along, 1.0 - kStrayShare);
  }
  return box;
}

/// Sizes of the panels; all have one scale and one centre.
struct Layout {
  Point3 centre_m;
  double px_per_m = 1.0;
  int side_axis = 0;  // x or y, to the right in the view from the side
  double above_px = 0.0;
  double side_px = 0.0;
};

// The start pose may be far off: it widens the panels to twice the size of the result at most.
Layout lay_out(std::span<const CloudPoint> a, std::span<const CloudPoint> b, const Pose3& start, const Pose3& end) {
  const Eigen::AlignedBox3d core = find_bulk(a, {}).merged(find_bulk(b, end));
  const Eigen::AlignedBox3d widest(core.min() - 0.5 * core.sizes(), core.max() + 0.5 * core.sizes());
  const Eigen::AlignedBox3d shown = core.merged(find_bulk(b, start).intersection(widest));
  const Point3 size = shown.sizes().cwiseMax(0.1);
  Layout layout{.centre_m = shown.center(), .side_axis = size.y() > size.x() ? 1 : 0};
  layout.px_per_m = (kColumn - 2.0 * kBorder) / size.maxCoeff();
  layout.above_px = std::floor(size.y() * layout.px_per_m + 2.0 * kBorder);
  layout.side_px = std::floor(size.z() * layout.px_per_m + 2.0 * kBorder);
  return layout;
}

// One point for each cube as wide as a cell, relative to the centre: scanners measure what is near more densely.
Cloud thin_out(std::span<const CloudPoint> cloud, const Pose3& T, const Layout& layout) {
  CloudKeeper kept;
  VoxelThinning thinning(1.0 / (kDensity * layout.px_per_m), cloud.size() + 1, kept);
  for (const CloudPoint& point : cloud) {
    const Point3 at = T * to_position(point) - layout.centre_m;
    const CloudPoint moved = to_cloud_point(at);
    if (at.cwiseAbs().maxCoeff() * layout.px_per_m < kColumn) thinning.add({&moved, 1});
  }
  return kept.cloud;
}

/// A panel: which axes it shows, where, and how many cells it has.
struct Panel {
  std::array<int, 2> axes{};  // to the right, up
  Point2 corner;
  double height = 0.0;
  double px_per_m = 1.0;
  [[nodiscard]] int columns() const { return kDensity * static_cast<int>(kColumn); }
  [[nodiscard]] int rows() const { return kDensity * static_cast<int>(height); }
};

// Opacity of each cell, greatest where many points lie behind each other, as those of a wall do from above.
std::vector<double> cell_opacities(const Panel& panel, const Cloud& cloud) {
  std::vector<double> cells(static_cast<std::size_t>(panel.columns() * panel.rows()));
  for (const CloudPoint& point : cloud) {
    const Point3 at = kDensity * panel.px_per_m * to_position(point);
    const int column = static_cast<int>(std::floor(0.5 * panel.columns() + at[panel.axes[0]]));
    const int row = static_cast<int>(std::floor(0.5 * panel.rows() - at[panel.axes[1]]));
    if (column < 0 || row < 0 || column >= panel.columns() || row >= panel.rows()) continue;
    ++*(cells.begin() + row * panel.columns() + column);
  }
  std::vector<double> filled = cells;
  std::erase(filled, 0.0);
  const double most = filled.empty() ? 1.0 : value_at_share(filled, 0.9);
  for (double& cell : cells) cell = cell > 0.0 ? std::clamp(cell / most, kFaintest, 1.0) : 0.0;
  return cells;
}

std::shared_ptr<const RgbaImage> overlay(const Panel& panel, const Cloud& a, const Cloud& b) {
  auto image = std::make_shared<RgbaImage>(panel.columns(), panel.rows());
  const std::vector<double> of_a = cell_opacities(panel, a);
  const std::vector<double> of_b = cell_opacities(panel, b);
  for (std::size_t k = 0; k < of_a.size(); ++k) {
    const Point3 shares(of_a[k] * (1.0 - of_b[k]), of_b[k] * (1.0 - of_a[k]), of_a[k] * of_b[k]);
    if (!(shares.sum() > 0.0)) continue;
    const auto mixed = [&](std::uint8_t Colour::*channel) {
      const Point3 inks(kInks[0].*channel, kInks[1].*channel, kInks[2].*channel);
      return static_cast<std::uint8_t>(inks.dot(shares) / shares.sum());
    };
    const std::array pixel{mixed(&Colour::red), mixed(&Colour::green), mixed(&Colour::blue),
                           static_cast<std::uint8_t>(255.0 * shares.sum())};
    std::copy(pixel.begin(), pixel.end(), image->pixels.begin() + static_cast<std::ptrdiff_t>(4 * k));
  }
  return image;
}

void draw_panel(Canvas& canvas, const Panel& panel, const Cloud& a, const Cloud& b) {
  canvas.rectangle(panel.corner, kColumn, panel.height, Fill{ink::kCard});
  draw_grid(canvas, {panel.corner, kColumn, panel.height}, panel.corner + 0.5 * Point2(kColumn, panel.height),
            round_length_m(kLongestBar / panel.px_per_m) * panel.px_per_m);
  canvas.picture(panel.corner, kColumn, panel.height, overlay(panel, a, b), false);
  canvas.rectangle(panel.corner, kColumn, panel.height, std::nullopt, Pen{.colour = ink::kEdge});
  const std::string words = fmt::format("from {}: {} right, {} up", panel.axes[1] == 1 ? "above" : "the side",
                                        "xy"[panel.axes[0]], "xyz"[panel.axes[1]]);
  canvas.text(panel.corner + Point2(10.0, 20.0), words, {.colour = ink::kQuiet, .has_halo = true});
}

void draw_head(Canvas& canvas, const std::string& title, double px_per_m) {
  canvas.rectangle({0.0, 0.0}, canvas.width(), canvas.height(), Fill{ink::kPage});
  canvas.text({kMargin, 52.0}, shortened_within(title, 24.0, kWidth - 2.0 * kMargin), {.size = 24.0});
  constexpr std::array kNames{"fixed cloud", "moved cloud", "both"};
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    const Point2 at(kMargin + 140.0 * static_cast<double>(k), 84.0);
    canvas.circle(at + Point2(6.0, -5.0), 6.0, Fill{kInks.at(k)});
    canvas.text(at + Point2(20.0, 0.0), kNames.at(k), {.size = 14.0});
  }
  draw_scale_bar(canvas, {.pixels_per_m = px_per_m, .most = kLongestBar, .has_halo = false}, {kMargin + 400.0, 84.0});
}

}  // namespace

Canvas draw_alignment(const std::string& title, std::span<const CloudPoint> a, std::span<const CloudPoint> b,
                      const Pose3& T_a_b_start, const Alignment& found) {
  const Layout layout = lay_out(a, b, T_a_b_start, found.T_a_b);
  const double side_top = kTop + layout.above_px + 0.5 * kMargin;
  Canvas canvas(kWidth, side_top + layout.side_px + kMargin, title);
  draw_head(canvas, title, layout.px_per_m);
  const Cloud thin_a = thin_out(a, {}, layout);
  for (const bool is_after : {false, true}) {
    const double left = kMargin + (is_after ? kColumn + 0.5 * kMargin : 0.0);
    const CloudFit& fit = is_after ? found.after : found.before;
    const Cloud thin_b = thin_out(b, is_after ? found.T_a_b : T_a_b_start, layout);
    canvas.text({left, 132.0}, is_after ? "Result" : "Start", {.size = 18.0, .is_bold = true});
    canvas.text({left, 156.0},
                fmt::format("overlap {:.0f} %  ·  on planes {:.0f} %  ·  median {:.1f} mm", 100.0 * fit.overlap,
                            100.0 * fit.on_planes, 1e3 * fit.median_m),
                {.size = 15.0, .colour = ink::kQuiet});
    draw_panel(canvas, {{0, 1}, {left, kTop}, layout.above_px, layout.px_per_m}, thin_a, thin_b);
    draw_panel(canvas, {{layout.side_axis, 2}, {left, side_top}, layout.side_px, layout.px_per_m}, thin_a, thin_b);
  }
  return canvas;
}

}  // namespace gdtslam
