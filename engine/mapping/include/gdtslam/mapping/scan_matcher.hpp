// Steps (6) to (8) and the minimisation of (4) for one scan: from a predicted pose down through narrowing gates, and
// through a window of poses where that descent may have ended in the wrong valley. Frame: map. Not thread-safe.
#pragma once

#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/exhaustive.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/match.hpp"
#include "gdtslam/mapping/motion_model.hpp"
#include "gdtslam/mapping/objective.hpp"

namespace gdtslam {

class ScanMatcher {
 public:
  ScanMatcher(const MapperConfig& config, Backend& backend, const GlobalField& map);

  /// Best pose of the points (cells, robot frame) near the prediction, with its evidence. `search` asks for a window
  /// even when the descent raises no suspicion.
  MatchResult match(const std::vector<PointCells>& points, const Prediction& prediction, bool search);

 private:
  struct Evidence {
    double mean_cost_m = 0.0;
    double overlap = 0.0;
    double contradiction = 0.0;
    StopReason stop = StopReason::kNotRun;
  };
  struct Estimate {
    CellPose pose;
    Evidence evidence;
  };

  void prepare(const Prediction& prediction);
  Estimate descend(const CellPose& start);
  void keep_points_within(std::uint32_t gate, const CellPose& pose);
  [[nodiscard]] Evidence judge(const CellPose& pose);
  [[nodiscard]] bool is_suspect(const Evidence& evidence) const;
  [[nodiscard]] bool is_far(const CellPose& pose, const Prediction& prediction) const;
  [[nodiscard]] bool is_beyond(const CellPose& pose, double allowed_m, double allowed_rad) const;
  [[nodiscard]] Doubt reservation_about(const Estimate& estimate, const Prediction& prediction) const;
  [[nodiscard]] Doubt doubt_of(const Evidence& evidence) const;
  Estimate search(const Estimate& local, const Prediction& prediction);
  [[nodiscard]] SearchWindow window_around(const Prediction& prediction, double scale) const;
  void choose_voters(const Estimate& local);
  [[nodiscard]] std::uint32_t cost_to_voters(const CellPose& pose);

  [[nodiscard]] std::uint32_t units(double metres) const;
  [[nodiscard]] float cells(double metres) const;

  MapperConfig config_;
  const GlobalField* map_;
  Objective objective_;
  CellPose predicted_;
  const std::vector<PointCells>* points_ = nullptr;
  std::vector<PointCells> kept_;     // points that pass the gate
  std::vector<PointCells> voters_;   // points that count in a window
  std::vector<PointCells> thinned_;  // and a share of them for its samples
  std::vector<std::uint16_t> values_;
};

}  // namespace gdtslam
