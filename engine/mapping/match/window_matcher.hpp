// The matcher `exhaustive`: all poses of a window around the prediction, simplexes from the best of them and from the
// prediction itself, through the narrowing gates, and the choice between their ends. All steps are kernels, so a scan
// is one upload, one submission and one download of a few words. A point beyond a gate counts as the gate, while
// `simplex` leaves it out. Frame: map. Not thread-safe. Cost: docs/benchmarks.md.
#pragma once

#include <vector>

#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "match_rules.hpp"
#include "matchers.hpp"

namespace gdtslam {

class WindowMatcher final : public Matcher {
 public:
  /// The map must outlive the matcher, which runs on the map's backend.
  WindowMatcher(const MapperConfig& config, const GlobalField& map);

  /// A window is always searched. While the best pose is suspect or lies at the window's edge, further windows follow,
  /// each twice as large. Throws DeviceError also if their poses, 16 bytes each, exceed the backend's largest buffer.
  MatchResult match(std::span<const PointCells> points, const Prediction& prediction, bool search) override;

 private:
  bool launch_wider();
  void launch(const SearchWindow& window);
  void launch_lattice();
  void launch_starts();
  void launch_verdict();
  void launch_descents();
  void launch_choice();
  [[nodiscard]] MatchVerdict wait();
  [[nodiscard]] bool is_better(const MatchVerdict& found, const MatchVerdict& best, const SearchWindow& before) const;
  [[nodiscard]] Evidence to_evidence(const MatchVerdict& verdict) const;
  [[nodiscard]] PoseLattice::Params lattice_params() const;
  [[nodiscard]] PoseCost::Params cost_params(std::uint32_t points, std::uint32_t cap) const;
  [[nodiscard]] PriorParams prior_of_share(double share) const;
  [[nodiscard]] std::uint32_t pose_count() const { return static_cast<std::uint32_t>(search_.starts) + 1; }

  MatchConfig match_;
  SearchConfig search_;
  DoubtConfig doubt_;
  Backend* backend_;
  const GlobalField* map_;
  MatchRules rules_;
  bool by_odometry_ = false;
  std::uint32_t points_ = 0;
  std::uint32_t thinned_ = 0;               ///< number of points for the window's costs
  std::vector<PointCells> ordered_points_;  ///< that share first
  SearchWindow window_;
  std::uint32_t samples_ = 0;
  std::uint32_t attempts_ = 0;
  PendingDownload pending_;
  Buffer point_buffer_;
  Buffer candidates_;
  Buffer costs_;
  Buffer minima_;
  Buffer picks_;
  Buffer poses_;
  Buffer verdict_;
};

}  // namespace gdtslam
