// The matchers that run on the host (matchers.hpp), with the map there. Steps (6) to (8) and the minimisation of (4)
// for one scan: from a predicted pose through narrowing gates, and through a window of poses if that descent may have
// ended in the wrong minimum. All threads of the CPU evaluate the samples of a window, generations and complexes.
// Frame: map. Not thread-safe.
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

class ScanMatcher final : public Matcher {
 public:
  /// The map must outlive the matcher and live on the CPU.
  ScanMatcher(const MapperConfig& config, const GlobalField& map);
  ~ScanMatcher() override;

  MatchResult match(std::span<const PointCells> points, const Prediction& prediction, bool search) override;

 private:
  struct Estimate {
    CellPose pose;
    Evidence evidence;
  };

  Estimate descend(const CellPose& start);
  PolishedPose descend_along_slope(const CellPose& start);
  PolishedPose descend_through_gates(const CellPose& start);
  [[nodiscard]] double mean_range_cells() const;
  void keep_points_within(std::uint32_t gate, const CellPose& pose);
  [[nodiscard]] Evidence judge(const CellPose& pose);
  Estimate search(const Estimate& local);
  void choose_voters(const Estimate& local);
  [[nodiscard]] std::uint32_t cost_to_voters(const CellPose& pose);

  [[nodiscard]] ExhaustiveResult find_in(const SearchWindow& window);
  [[nodiscard]] ExhaustiveResult prove_in(const SearchWindow& window);

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
  std::uint32_t attempts_ = 0;       // windows searched for this scan
  std::vector<PointCells> kept_;     // points that pass the gate
  std::vector<PointCells> voters_;   // points that count in a window
  std::vector<PointCells> thinned_;  // a share of them for the window's samples
  std::vector<std::uint16_t> values_;
  Isa isa_;
  std::unique_ptr<CertifiedCrop> crop_;  // crop of the matcher certified
  std::optional<double> proven_gap_m_;
  std::uint64_t proof_evaluations_ = 0;
};

}  // namespace gdtslam
