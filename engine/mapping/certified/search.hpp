// One search of find_pose(): the open boxes, the best pose so far and the proof. Poses are in cells and radians
// relative to the anchor, a map cell near the window's centre.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/compute/kernels/pose_bounds/pose_bounds.hpp"
#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"
#include "engine/mapping/cost/objective.hpp"
#include "field.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {

/// No cost at all.
inline constexpr std::uint32_t kNoCost = 0xFFFFFFFFU;

/// A box of poses that may hold the best one.
struct OpenBox {
  std::uint32_t bound = 0;  ///< no pose in it costs less
  std::uint32_t terms = 0;  ///< the points' part of the bound
  std::int32_t level = 0;   ///< determines its size
  CellPose centre;
  std::uint64_t order = 0;  ///< order in which boxes were made: breaks ties
};

class CertifiedSearch {
 public:
  CertifiedSearch(const CertifiedMap& map, std::span<const PointCells> points, const PoseWindow& window,
                  const CertifiedOptions& options);
  CertifiedResult run();

 private:
  void choose_levels();
  void choose_reaches(std::int32_t level);
  void prepare_points();
  [[nodiscard]] std::uint64_t boxes_at(std::size_t level) const;
  [[nodiscard]] bool has_fields(std::int32_t level) const { return level < field_levels_; }
  [[nodiscard]] const BoundLevel& fields(std::int32_t level) const;
  [[nodiscard]] float half_width(std::int32_t level) const { return half_widths_[static_cast<std::size_t>(level)]; }
  [[nodiscard]] float half_angle(std::int32_t level) const { return half_angles_[static_cast<std::size_t>(level)]; }

  // Bounds.
  void open_window();
  void expand(const OpenBox& box);
  void halve(const OpenBox& box);
  void bound_tiles(std::int32_t level, std::span<const PoseCandidate> corners, std::uint32_t tile_width,
                   std::uint32_t tile_height, std::uint32_t known_bound);
  void sum_tiles(const PoseBounds::Params& params, std::int32_t level, std::span<const PoseCandidate> corners);
  void keep(OpenBox box);
  [[nodiscard]] bool has_wide_minorant(std::int32_t level) const;
  std::optional<PoseMinorant::Value> minorant_in(const OpenBox& box);
  [[nodiscard]] PoseMinorant::Value find_patch_minorant(const OpenBox& box) const;
  [[nodiscard]] PoseMinorant::Value find_wide_minorant(const OpenBox& box) const;
  [[nodiscard]] std::uint32_t least_value(const PoseMinorant::Value& minorant, const OpenBox& box,
                                          const OpenBox& part) const;
  [[nodiscard]] bool matters(const OpenBox& box) const;
  [[nodiscard]] bool is_within(const OpenBox& box, const ExcludedPoses& excluded) const;
  [[nodiscard]] std::uint32_t least_prior(const OpenBox& box) const;

  // Poses.
  void try_starts();
  void try_centres(std::span<const OpenBox> boxes);
  void polish(const CellPose& start, float step_cells);
  void offer(const CellPose& pose, std::uint32_t cost);
  [[nodiscard]] std::uint32_t evaluate_cost(const CellPose& pose);
  [[nodiscard]] CellPose to_cells(const Pose2& pose) const;
  [[nodiscard]] Pose2 to_metres(const CellPose& pose) const;
  [[nodiscard]] CellPose in_narrow_window(CellPose pose) const;
  [[nodiscard]] bool is_allowed(const CellPose& pose) const;

  // Proof.
  void work_through();
  [[nodiscard]] std::uint32_t enough() const;
  void give_up(std::uint32_t bound) { closed_bound_ = bound < closed_bound_ ? bound : closed_bound_; }
  [[nodiscard]] std::optional<CertifiedStop> limit_reached() const;
  [[nodiscard]] CertifiedResult result() const;

  const CertifiedMap& map_;
  std::vector<PointCells> points_;
  PoseWindow window_;
  const CertifiedOptions& options_;
  CellIndex anchor_;
  CellPose centre_;
  float half_x_ = 0.0F;
  float half_y_ = 0.0F;
  float half_theta_ = 0.0F;
  // A window that is too narrow in a direction for boxes to have their centres in it: poses are moved into it.
  bool is_narrow_x_ = false;
  bool is_narrow_y_ = false;
  bool is_narrow_theta_ = false;
  float slack_ = 0.0F;      // cells
  float reference_ = 0.0F;  // range at which a box's angle moves a point as far as its width does, cells
  PriorParams prior_;
  PoseCost::Params cost_params_;

  std::size_t first_level_ = 0;     // first of the map's levels used in the search
  std::int32_t field_levels_ = 0;   // number of levels with fields
  std::vector<float> half_widths_;  // half widths of the boxes of each level
  std::vector<float> half_angles_;
  float top_angle_ = 0.0F;
  std::uint32_t top_angles_ = 1;
  std::vector<std::vector<BoundPoint>> bound_points_;  // bound points of each of those levels

  std::vector<std::vector<BoundPoint>> wide_points_;  // points of the first levels without dilated fields

  std::uint32_t gap_ = 0;      // cost units
  std::vector<OpenBox> open_;  // a heap once the window is open
  std::uint64_t made_ = 0;
  std::vector<std::uint32_t> sums_;
  std::uint32_t best_cost_ = kNoCost;
  CellPose best_;
  std::uint32_t closed_bound_ = kNoCost;  // least bound of the boxes that were closed
  bool at_resolution_ = false;
  std::uint64_t boxes_ = 0;
  std::uint64_t uncounted_ = 0;  ///< boxes that the limit does not count
  std::uint64_t evaluations_ = 0;
  CertifiedStop stop_ = CertifiedStop::kGapReached;
  std::chrono::steady_clock::time_point began_;
};

}  // namespace gdtslam
