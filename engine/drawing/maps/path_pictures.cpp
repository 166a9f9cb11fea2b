#include "path_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "engine/core/quantile.hpp"
#include "gdtslam/core/error.hpp"
#include "map_sheet.hpp"
#include "path_layer.hpp"

namespace gdtslam {
namespace {

using namespace picture;

constexpr Colour kTruth = colour_for(0x9aa0a8);
constexpr Colour kNoError = colour_for(0xc3c7cc);  ///< of a pose that the truth does not know
constexpr double kTruthWidths = 2.6;               ///< of a path's line, of the truth under others
constexpr double kErrorWidths = 2.2;               ///< likewise of a path whose colour is what is read

/// The area of the poses, with a margin.
MapArea area_of_paths(const std::vector<const Trajectory*>& paths) {
  constexpr double kLeastSide_m = 1.0;
  constexpr double kMarginShare = 0.04;
  MapArea area{std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
               std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()};
  for (const Trajectory* const path : paths) {
    for (const StampedPose& pose : *path) {
      if (!pose.T_map_base.is_finite()) continue;
      area.min_x_m = std::min(area.min_x_m, pose.T_map_base.x_m);
      area.max_x_m = std::max(area.max_x_m, pose.T_map_base.x_m);
      area.min_y_m = std::min(area.min_y_m, pose.T_map_base.y_m);
      area.max_y_m = std::max(area.max_y_m, pose.T_map_base.y_m);
    }
  }
  if (area.min_x_m > area.max_x_m) area = {0.0, 0.0, 0.0, 0.0};  // no pose is a number
  const double margin_m = kMarginShare * std::max({area.width_m(), area.height_m(), kLeastSide_m});
  const double wider_m = margin_m + 0.5 * std::max(0.0, kLeastSide_m - area.width_m());
  const double higher_m = margin_m + 0.5 * std::max(0.0, kLeastSide_m - area.height_m());
  return {area.min_x_m - wider_m, area.min_y_m - higher_m, area.max_x_m + wider_m, area.max_y_m + higher_m};
}

MapSheet page_of_paths(const char* name, const std::vector<const Trajectory*>& paths) {
  MapSheet sheet{name, area_of_paths(paths), kLightTheme, {grid_layer(kLightTheme.grid)}};
  sheet.theme.page = ink::kCard;
  return sheet;
}

/// Least and most of what is coloured, and whether there is more.
struct ErrorScale {
  double least = 0.0;
  double most = 1.0;
  bool ends_early = false;
};

/// A few errors far out would leave one colour to all others: where the largest is far above the 99th percentile, the
/// scale ends there and says so.
ErrorScale scale_of(const PathErrors& path) {
  constexpr double kShare = 0.99;
  constexpr double kFar = 1.5;
  std::vector<double> known;
  for (const double error : path.errors) {
    if (std::isfinite(error)) known.push_back(error);
  }
  if (known.empty()) throw InputError("none of the poses has an error to colour it by");
  std::sort(known.begin(), known.end());
  const double usual = quantile_of_sorted(known, kShare);
  const double shown = known.back() > kFar * usual ? usual : known.back();
  ErrorScale scale{path.least.value_or(0.0), path.most.value_or(shown)};
  if (!(scale.least < scale.most)) scale.most = scale.least + 1.0;
  scale.ends_early = known.back() > scale.most;
  return scale;
}

}  // namespace

PictureSize size_for_paths(const std::vector<const Trajectory*>& paths) {
  const MapArea area = area_of_paths(paths);
  return size_for_content(area.width_m(), area.height_m());
}

Canvas trajectory_picture(const PathOverlay& path, const MapLook& look, const PictureSize& size) {
  check(path);
  const PathColours colours = path_colours(false, look.colour_map);
  MapSheet sheet = page_of_paths("Trajectory", {&path.trajectory});
  sheet.layers.push_back(path_layer(path, look, colours));
  return drawn(sheet, look, size);
}

Canvas trajectories_picture(const std::vector<NamedPath>& paths, const Trajectory* truth, const MapLook& look,
                            const PictureSize& size) {
  const std::vector<std::size_t> one_drive;
  const double width = proportions_of(size).line_px;
  std::vector<const Trajectory*> all;
  for (const NamedPath& path : paths) all.push_back(&path.trajectory);
  if (truth != nullptr) all.push_back(truth);
  MapSheet sheet = page_of_paths("Trajectories", all);
  const Colour halo = truth != nullptr ? kTruth : sheet.theme.page;
  if (truth != nullptr) {
    sheet.layers.push_back(line_layer(*truth, one_drive, "truth", kTruth, {sheet.theme.page, kTruthWidths * width}));
  }
  for (std::size_t k = 0; k < paths.size(); ++k) {
    sheet.layers.push_back(
        line_layer(paths[k].trajectory, paths[k].drives, paths[k].name, sheet.theme.curve(k), {halo, width}));
  }
  return drawn(sheet, look, size);
}

Canvas path_errors_picture(const PathErrors& path, const Trajectory& truth, const MapLook& look,
                           const PictureSize& size) {
  const std::vector<std::size_t> one_drive;
  const ErrorScale scale = scale_of(path);
  const ColourMap& map = colour_map(look.colour_map.empty() ? "lagoon" : look.colour_map);
  const double width = proportions_of(size).line_px;
  std::vector<double> shares;
  for (const double error : path.errors) shares.push_back((error - scale.least) / (scale.most - scale.least));
  MapSheet sheet = page_of_paths("Errors along the path", {&path.trajectory, &truth});
  const Colour page = sheet.theme.page;
  sheet.layers.push_back(line_layer(truth, one_drive, "truth", kTruth, {page, width}));
  sheet.layers.push_back({[&](Canvas& canvas, const MapFrame& frame, const Proportions& /*sizes*/) {
                            const auto colour_at = [&map](double share) {
                              return std::isfinite(share) ? map.at(share) : kNoError;
                            };
                            draw_line_of_values(canvas, frame, {path.trajectory, path.drives, shares}, colour_at,
                                                {page, kErrorWidths * width});
                          },
                          [&](const LegendLook& legend, double /*px_per_m*/) {
                            return LegendItems{colour_bar_item(
                                fmt::format("{}  {:.3g}", path.quantity, scale.least),
                                fmt::format("{:.3g}{}", scale.most, scale.ends_early ? " and more" : ""),
                                [&map](double share) { return map.at(share); }, legend)};
                          }});
  return drawn(sheet, look, size);
}

}  // namespace gdtslam
