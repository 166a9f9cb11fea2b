// All matchers (matchers.hpp): steps (6) to (8) and the minimisation of (4) for one scan, from a predicted pose through
// narrowing gates, and through a window of poses if that descent may have ended in the wrong minimum. Where the map
// lies: on this thread, with all threads of the CPU for the samples of a window, or on a device. Then a descent is one
// dispatch and a window two, and the host judges by the values under the points. Frame: map. Not thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/mapping/cost/objective.hpp"
#include "exhaustive.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "match_rules.hpp"
#include "matchers.hpp"

namespace gdtslam {

class CertifiedCrop;

class ScanMatcher {
 public:
  /// The map must outlive the matcher, and lie on the CPU unless the matcher follows the slope.
  ScanMatcher(const MapperConfig& config, const GlobalField& map);
  ScanMatcher(const ScanMatcher&) = delete;
  ScanMatcher& operator=(const ScanMatcher&) = delete;
  ~ScanMatcher();

  /// Best pose of the points (cells, robot frame; at least one, at most kMostMatchedPoints) near the prediction, with
  /// its evidence. `search` requests a window even if a descent from the prediction raises no suspicion. Throws
  /// DeviceError if the map's device fails.
  MatchResult match(std::span<const PointCells> points, const Prediction& prediction, bool search);

 private:
  struct Estimate {
    CellPose pose;
    Evidence evidence;
  };

  void descend(std::span<const CellPose> starts);
  void descend_through_gates(PolishedPose& pose, std::span<std::uint16_t> values);
  [[nodiscard]] double mean_range_cells() const;
  void keep_points_within(std::uint32_t gate, const CellPose& pose);
  [[nodiscard]] std::size_t row() const { return PoseDescent::row_of(static_cast<std::uint32_t>(points_.size())); }
  [[nodiscard]] std::span<std::uint16_t> values_at(std::size_t end);
  [[nodiscard]] Estimate estimate(std::size_t end);
  [[nodiscard]] bool is_leap(const CellPose& pose, const CellPose& local, const SearchWindow& before) const;
  Estimate search(const Estimate& local);
  void choose_voters(const Estimate& local);
  [[nodiscard]] std::uint64_t cost_to_voters(std::size_t end);
  [[nodiscard]] std::vector<CellPose> starts_in(const SearchWindow& window);
  [[nodiscard]] CellPose prove_in(const SearchWindow& window);

  const MatcherInfo* matcher_;
  OptimizerConfig optimizer_;
  GateConfig gate_;
  SearchConfig search_;
  double leap_gain_;
  const GlobalField* map_;
  MatchRules rules_;
  Objective objective_;
  std::span<const PointCells> points_;
  bool by_odometry_ = false;
  std::uint32_t attempts_ = 0;         // windows searched for this scan
  std::vector<PointCells> kept_;       // points that pass the gate
  std::vector<PointCells> voters_;     // points that count in a window
  std::vector<PointCells> thinned_;    // a share of them for the window's samples
  std::vector<std::uint8_t> votes_;    // 1 for each point that does
  std::vector<PolishedPose> ends_;     // of the last descents
  std::vector<std::uint16_t> values_;  // under all points at each of them, nearest cell
  std::vector<std::uint16_t> gated_;
  Isa isa_;
  std::unique_ptr<CertifiedCrop> crop_;  // crop of the matcher certified
  std::optional<double> proven_gap_m_;
  std::uint64_t proof_evaluations_ = 0;
};

}  // namespace gdtslam
