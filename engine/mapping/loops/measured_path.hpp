// The path as it was measured twice, by the front end and by the wheels alone: which of the two is to be believed, and
// how much, only shows where loops tie the path to itself. Frame: that of the first keyframe. Not thread-safe. Linear
// in the keyframes.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/core/memory/sparing.hpp"
#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/graph/variance_components.hpp"
#include "engine/mapping/loops/scan_group.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "engine/mapping/wheels/wheel_bias.hpp"

namespace gdtslam {

/// The pose of a keyframe in the frame of the one before it, by one of the two.
struct MeasuredStep {
  Pose2 T;
  Matrix3 information{};  ///< information of the tangent at T
  Matrix3 cautious{};     ///< the same where the scan's distance from the map counts as noise: for covariances alone
  Matrix3 blind{};   ///< covariance of a match relative to the last place, along directions that surfaces do not hold
                     ///< (MatchChain)
  Matrix3 unseen{};  ///< covariance of the pose at a match's end along directions that no known surface shows
};

/// Travel of the wheels from one keyframe to the next, whose noise is known better once the log has ended.
struct WheelTravel {
  double path_m = 0.0;
  double turned_rad = 0.0;
  Matrix3 besides{};          ///< covariance of all that is not the wheels' noise: leaps, steps that nothing measured
  bool is_measured = true;    ///< all of it, by odometry
  bool is_way_known = false;  ///< by the scan at its end: knows_way()
  bool is_matched = true;     ///< that scan; else it lies where the wheels said, and tells nothing of them
};

enum class StepSource : std::size_t { kFrontEnd = 0, kWheels = 1 };
inline constexpr std::size_t kStepSources = 2;
using MeasuredSteps = std::array<MeasuredStep, kStepSources>;

/// By both sources together. `steps` must tell something.
inline StepDoubt step_doubt(const MeasuredSteps& steps) {
  return {.step = inverse(steps[0].information + steps[1].information), .unseen = steps[0].unseen};
}

/// Path of the front end: one entry a keyframe in each.
struct FrontEndPath {
  KeptScans scans;  ///< scans that are needed still (PlacePruning)
  std::vector<Pose2> poses;
  std::vector<double> path_m;        ///< travelled until each
  std::vector<StepDoubt> doubts;     ///< doubt of each keyframe relative to the one before, by all measurements
  std::vector<MeasuredSteps> steps;  ///< to each from the one before; of the first nothing
  std::size_t first_step = 0;        ///< the keyframe that `steps` begin with: those before it wait on a shelf
  std::vector<WheelTravel>
      travels;  ///< to each; empty while the path grows, and where the noise of the wheels' steps stays as it is stated

  [[nodiscard]] const MeasuredSteps& steps_to(std::size_t keyframe) const { return steps[keyframe - first_step]; }
};

class MeasuredPath {
 public:
  /// Between places, which are keyframes, ascending; `path` must outlive this.
  MeasuredPath(const FrontEndPath& path, std::vector<std::size_t> places);

  /// One place more, a keyframe behind the last place.
  void add_place(std::size_t keyframe) { push_sparingly(places_, keyframe); }

  [[nodiscard]] const std::vector<std::size_t>& places() const { return places_; }
  /// Which information of a step counts.
  using Information = Matrix3 MeasuredStep::*;
  /// From place to place by the matches, and by the wheels, as much as they are believed now; a factor of the wheels'
  /// variance below `least_factor` counts as that.
  [[nodiscard]] std::vector<PoseRelation> matches(Information information = &MeasuredStep::information) const;
  [[nodiscard]] std::vector<WheelRelation> wheels(double least_factor = 0.0) const;
  /// To a place from the one before it, as the matches state it.
  [[nodiscard]] PoseRelation by_front_end(std::size_t place) const {
    return between_places(place, StepSource::kFrontEnd).relation;
  }
  /// The same by the wheels.
  [[nodiscard]] WheelRelation by_wheels(std::size_t place) const { return between_places(place, StepSource::kWheels); }
  /// Between two keyframes, as far as the source is believed now.
  [[nodiscard]] PoseRelation stretch(std::size_t from, std::size_t to, StepSource source) const;

  /// Corrects the wheels by the bias that the graph found, whose own bias is zero from then on.
  void correct_wheels(PoseGraph& graph);
  /// States the noise of the wheels anew from keyframes that are known better: it was stated step by step, when little
  /// was known of it.
  void state_wheel_noise(const std::vector<Pose2>& keyframes);
  [[nodiscard]] const WheelBias& wheel_bias() const { return bias_; }
  /// How far each source is to be believed: the matches by what the loops that are on say of them, the wheels by how
  /// far they are off the graph from place to place.
  void weigh(const PoseGraph& graph);
  /// Both sources, their variances by this factor.
  void believe_less(double factor) {
    for (VarianceFactor& source : factors_) {
      source.variance *= factor;
      source.turn_variance *= factor;
    }
  }
  void believe_as_stated() { factors_ = {}; }
  [[nodiscard]] const std::array<VarianceFactor, kStepSources>& factors() const { return factors_; }

 private:
  [[nodiscard]] WheelRelation stated(std::size_t from, std::size_t to, StepSource source,
                                     Information information = &MeasuredStep::information) const;
  [[nodiscard]] WheelRelation matches_between(std::size_t from, std::size_t to, Information information) const;
  [[nodiscard]] WheelRelation wheels_between(std::size_t from, std::size_t to) const;
  [[nodiscard]] WheelRelation between_places(std::size_t place, StepSource source,
                                             Information information = &MeasuredStep::information) const;
  [[nodiscard]] std::vector<WheelRelation> all_between_places(StepSource source, Information information,
                                                              const VarianceFactor& factor) const;
  [[nodiscard]] VarianceFactor factor_of_wheels(const PoseGraph& graph) const;
  [[nodiscard]] VarianceFactor factor_beside_good_wheels() const;

  const FrontEndPath& path_;
  std::vector<std::size_t> places_;
  std::array<VarianceFactor, kStepSources> factors_;
  WheelBias bias_;
  bool are_wheels_good_ = false;            // loops found them good: their own headings count
  std::vector<Matrix3> wheel_information_;  // information of each step with hindsight; empty before
};

}  // namespace gdtslam
