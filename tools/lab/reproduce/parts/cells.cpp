// Figure 3: a small distance transform with its numbers, beside the ones that the paper prints.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "engine/mapping/map/local_field.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "tools/lab/reproduce/part.hpp"

namespace gdtslam::reproduce {
namespace {

constexpr int kSide = 10;
constexpr std::uint32_t kRadius_cells = 32;
using Grid = std::array<std::string_view, kSide>;

// Figure 3(b) as printed, the upper row first; its zeros are the obstacles of figure 3(a).
constexpr Grid kPrinted{"4323432334", "3212321223", "2101210123", "2101210123", "2101210123",
                        "2101110123", "2100000123", "3211111223", "4322222234", "5433333334"};

// x to the right, y up, as in a map.
int printed_at(int x, int y) {
  return kPrinted[static_cast<std::size_t>(kSide - 1 - y)][static_cast<std::size_t>(x)] - '0';
}

template <class Action>
void for_each_cell(const Action& action) {
  for (int k = 0; k < kSide * kSide; ++k) action(k % kSide, k / kSide);
}

// The window holds all that the obstacles reach, as a keyframe's does; its cells count from its corner.
KeyframeCells obstacles() {
  constexpr int kReach = kRadius_cells;
  KeyframeCells keyframe;
  keyframe.window = {{-kReach, -kReach}, {kSide + kReach, kSide + kReach}};
  for_each_cell([&](int x, int y) {
    if (printed_at(x, y) != 0) return;
    keyframe.cells.push_back(static_cast<std::uint32_t>(y + kReach) << 16U | static_cast<std::uint32_t>(x + kReach));
  });
  return keyframe;
}

// By the kernels that make every map: a first keyframe is the map. Cut to the cells of the figure.
FieldPicture transformed(const KeyframeCells& keyframe, Backend& backend) {
  GlobalField field(backend, 1.0, kRadius_cells, 1U << 20U);
  LocalField local(backend, kRadius_cells);
  const MergeStep step{};
  field.grow_to_hold(keyframe.window);
  local.prepare(keyframe, field);
  local.merge_into(field, step);
  FieldPicture picture{GridGeometry{1.0, 0.0, 0.0, kSide, kSide}, {}, field.cap()};
  for (std::int32_t k = 0; k < kSide * kSide; ++k) picture.cells.push_back(field.at({k % kSide, k / kSide}));
  return picture;
}

double city_block(int dx, int dy) { return std::abs(dx) + std::abs(dy); }
double euclidean(int dx, int dy) { return std::sqrt(static_cast<double>(dx * dx + dy * dy)); }
using Metric = double (*)(int, int);

// To the nearest obstacle, by definition.
double least_distance(int x, int y, Metric metric) {
  double least = 2.0 * kSide;
  for_each_cell([&](int u, int v) {
    if (printed_at(u, v) == 0) least = std::min(least, metric(x - u, y - v));
  });
  return least;
}

bool is_printed(int x, int y, Metric metric) {
  return std::floor(least_distance(x, y, metric) + 0.5) == printed_at(x, y);
}

int agreeing_cells(Metric metric) {
  int agreeing = 0;
  for_each_cell([&](int x, int y) { agreeing += is_printed(x, y, metric) ? 1 : 0; });
  return agreeing;
}

double distance_cells(const FieldPicture& field, int x, int y) {
  return field.cells[static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x)] / 256.0;
}

// Cells of the field that differ from the definition, to half a step of 1/256 cell.
int wrong_cells(const FieldPicture& field) {
  int wrong = 0;
  for_each_cell([&](int x, int y) {
    wrong += std::abs(distance_cells(field, x, y) - least_distance(x, y, euclidean)) > 0.5 / 256.0 ? 1 : 0;
  });
  return wrong;
}

struct CellLook {
  std::string text{};
  Colour paper = ink::kCard;
  Colour ink = ink::kText;
  bool is_bold = false;
};
CellLook obstacle_look() { return {"0", ink::kText, ink::kCard}; }

// Squares with a word each; what is marked stands out.
template <class Look>
Canvas sheet(std::string_view title, std::string_view subtitle, const Look& look_of_cell) {
  constexpr double kMargin = 28.0;
  constexpr double kCell = 56.0;
  constexpr double kTop = 92.0;
  Canvas canvas(2.0 * kMargin + kSide * kCell, kTop + kSide * kCell + kMargin, title);
  canvas.rectangle({0.0, 0.0}, canvas.width(), canvas.height(), Fill{ink::kCard});
  canvas.text({kMargin, 46.0}, title, {.size = 22.0, .is_bold = true});
  canvas.text({kMargin, 72.0}, subtitle, {.size = 15.0, .colour = ink::kQuiet});
  for_each_cell([&](int x, int y) {
    const CellLook look = printed_at(x, y) == 0 ? obstacle_look() : look_of_cell(x, y);
    const Point2 corner(kMargin + kCell * x, kTop + kCell * (kSide - 1 - y));
    canvas.rectangle(corner, kCell, kCell, Fill{look.paper}, Pen{.colour = ink::kEdge});
    canvas.text(corner + Point2(0.5 * kCell, 0.5 * kCell + 7.0), look.text,
                {.size = 20.0, .colour = look.ink, .anchor = Anchor::kMiddle, .is_bold = look.is_bold});
  });
  return canvas;
}

Canvas before() {
  return sheet("Before the transform", "Obstacles hold 0, all other cells infinity",
               [](int, int) { return CellLook{"\u221e"}; });
}

Canvas printed() {
  return sheet("As the paper prints it", "Marked: not the Euclidean distance, rounded", [](int x, int y) {
    const std::string value = std::to_string(printed_at(x, y));
    return is_printed(x, y, euclidean) ? CellLook{value} : CellLook{value, colour_for(0xffdcc4), ink::kWarning, true};
  });
}

// Light near the obstacles, so that every number is legible.
Canvas after(const FieldPicture& field) {
  return sheet("After: the exact distance", "Euclidean, in cells, to one decimal", [&field](int x, int y) {
    constexpr double kFarthest_cells = 5.0;
    const double distance = distance_cells(field, x, y);
    return CellLook{fmt::format("{:.1f}", distance), colour_map("lagoon").at(1.0 - 0.5 * distance / kFarthest_cells)};
  });
}

}  // namespace

Part make_cells(const PartContext& place) {
  const std::unique_ptr<Backend> backend = make_backend(place.device);
  const FieldPicture field = transformed(obstacles(), *backend);
  Part part;
  part.origin = Origin::kComputed;
  part.source =
      "From the obstacles that figure 3(a) prints, by the kernels that make every map; no sensor is involved.";
  add_picture(part, place, before(), {"before.svg", "(a) The obstacles of figure 3(a).", 3});
  add_picture(part, place, after(field),
              {"after.svg", "(b) Their distance transform, equation (1) with the root taken: exact to 1/256 cell.", 3});
  add_picture(part, place, printed(),
              {"printed.svg", "(b) of the paper, for comparison. Marked: not the Euclidean distance, rounded.", 3});
  const int wrong = wrong_cells(field);
  part.claim(
      "cells off the Euclidean distance", "", fmt::format("{} of 100", wrong), wrong == 0,
      "the paper states the Euclidean distance; held against the minimum over all obstacles, to half of 1/256 cell");
  part.claim("print = Euclidean, rounded", "100 of 100 (claimed)", fmt::format("{} of 100", agreeing_cells(euclidean)),
             false, "what is printed is not what equation (1) and the text say");
  part.state("print = city block", "", fmt::format("{} of 100", agreeing_cells(city_block)),
             "the metric that comes nearest to the print; it is no reference for either");
  part.notes.push_back(
      "Equation (1) as printed is a minimum over all cells and so zero everywhere; \"(i, j) an obstacle\" is added. It "
      "is a square, while (8) compares it with metres: maps hold the distance.");
  part.by_hand = {"gdtslam render RUN --view cells -o cells.svg        # the same of any map"};
  return part;
}

}  // namespace gdtslam::reproduce
