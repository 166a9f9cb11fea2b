// Fields and scans for the tests of certified matching, and what the true cost of a pose is: the oracle of pose_cost.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/mapping/cost/objective.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam::test {

/// kExact: distances to walls. kSteps: what merging leaves behind, made worse: patches of any height side by side,
/// walls (0) next to the unknown (the cap). kNoise: every cell by itself.
enum class FieldKind : std::uint8_t { kExact, kSteps, kNoise };
const char* to_string(FieldKind kind);

struct TestField {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint16_t cap = 0;
  CellIndex first_cell;
  std::vector<std::uint16_t> cells;
  [[nodiscard]] FieldView view() const { return {cells.data(), width, height, width, first_cell, cap, kResolution}; }
  static constexpr double kResolution = 0.05;
};
TestField make_field(FieldKind kind, Random& random);

/// A scan of a robot that stands in the field: some of its points on low cells, some anywhere, some off the map.
std::vector<PointCells> make_scan(const TestField& field, const Pose2& T_map_base, std::size_t count, Random& random);

/// A field, a robot in it, at least `margin` cells from its edges, and the scan that it takes there.
struct FieldScene {
  TestField field;
  Pose2 T_map_base;
  std::vector<PointCells> points;
};
FieldScene make_field_scene(FieldKind kind, std::size_t points, double margin, Random& random);

/// The kinds of fields as parameters of a suite, and what a test of them is called.
inline constexpr std::array kFieldKinds{FieldKind::kExact, FieldKind::kSteps, FieldKind::kNoise};
inline const auto kNameOfKind = [](const auto& kind) { return to_string(kind.param); };

/// The cost of a pose given in cells from an anchor cell.
std::uint32_t true_cost(const TestField& field, const std::vector<PointCells>& points, CellIndex anchor,
                        const CellPose& pose);

/// The least cost that a dense grid over the window finds, polished from its best places. An upper bound of the
/// optimum, and close to it.
std::uint32_t searched_optimum(const FieldView& field, const std::vector<PointCells>& points, const PoseWindow& window,
                               std::uint32_t steps_xy, std::uint32_t steps_theta);

}  // namespace gdtslam::test
