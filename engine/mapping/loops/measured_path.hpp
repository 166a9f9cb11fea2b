// The path as measured twice, by the front end and by the wheels alone. How reliable each source is shows only when
// loops tie the path to itself. Frame: that of the first keyframe. Not thread-safe. Linear in the keyframes.
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

/// The pose of a keyframe in the frame of the one before it, measured by one source.
struct MeasuredStep {
  Pose2 T;
  Matrix3 information{};  ///< information of the tangent at T
  Matrix3 cautious{};     ///< the same with the scan's distance from the map as noise: for covariances alone
  Matrix3 blind{};   ///< covariance of a match relative to the last place, along directions that surfaces leave free
                     ///< (MatchChain)
  Matrix3 unseen{};  ///< covariance of the pose at a match's end along directions that no known surface shows
};

/// Travel of the wheels from one keyframe to the next; its noise is known better once the log has ended.
struct WheelTravel {
  double path_m = 0.0;
  double turned_rad = 0.0;
  Matrix3 besides{};          ///< covariance besides the wheels' noise: leaps, and steps that nothing measured
  bool is_measured = true;    ///< true if odometry measured all of it
  bool is_way_known = false;  ///< true if the scan at its end shows the way: knows_way()
  bool is_matched = true;     ///< true if that scan was matched; else its pose comes from the wheels and says nothing
                              ///< about them
};

enum class StepSource : std::size_t { kFrontEnd = 0, kWheels = 1 };
inline constexpr std::size_t kStepSources = 2;
using MeasuredSteps = std::array<MeasuredStep, kStepSources>;

/// Doubt of a step by both sources together. `steps` must have information in all directions.
inline StepDoubt step_doubt(const MeasuredSteps& steps) {
  return {.step = inverse(steps[0].information + steps[1].information), .unseen = steps[0].unseen};
}

/// Path of the front end: one entry a keyframe in each.
struct FrontEndPath {
  KeptScans scans;  ///< scans that are still needed (PlacePruning)
  std::vector<Pose2> poses;
  std::vector<double> path_m;        ///< path length up to each keyframe
  std::vector<StepDoubt> doubts;     ///< doubt of each keyframe relative to the one before, by all measurements
  std::vector<MeasuredSteps> steps;  ///< from each keyframe's predecessor to it; the first has none
  std::size_t first_step = 0;        ///< first keyframe in `steps`: earlier steps wait on a shelf
  std::vector<WheelTravel>
      travels;  ///< to each keyframe; empty while the path grows, and if the noise of the wheels' steps stays as stated

  [[nodiscard]] const MeasuredSteps& steps_to(std::size_t keyframe) const { return steps[keyframe - first_step]; }
};

class MeasuredPath {
 public:
  /// `places` are ascending keyframes; `path` must outlive this.
  MeasuredPath(const FrontEndPath& path, std::vector<std::size_t> places);

  /// Adds a place: a keyframe later than the last place.
  void add_place(std::size_t keyframe) { push_sparingly(places_, keyframe); }

  [[nodiscard]] const std::vector<std::size_t>& places() const { return places_; }
  /// Selects the information of a step.
  using Information = Matrix3 MeasuredStep::*;
  /// Relations from place to place by the matches and by the wheels, with their current weights. A factor of the
  /// wheels' variance below `least_factor` is raised to it.
  [[nodiscard]] std::vector<PoseRelation> matches(Information information = &MeasuredStep::information) const;
  [[nodiscard]] std::vector<WheelRelation> wheels(double least_factor = 0.0) const;
  /// Relation to a place from the one before it, as the matches state it.
  [[nodiscard]] PoseRelation by_front_end(std::size_t place) const {
    return between_places(place, StepSource::kFrontEnd).relation;
  }
  /// The same by the wheels.
  [[nodiscard]] WheelRelation by_wheels(std::size_t place) const { return between_places(place, StepSource::kWheels); }
  /// Relation between two keyframes, with the current weight of the source.
  [[nodiscard]] PoseRelation stretch(std::size_t from, std::size_t to, StepSource source) const;

  /// Corrects the wheels by the bias that the graph found, and sets the graph's bias to zero.
  void correct_wheels(PoseGraph& graph);
  /// Computes the noise of the wheels anew from final keyframes: the first estimate was made step by step, with little
  /// data.
  void state_wheel_noise(const std::vector<Pose2>& keyframes);
  [[nodiscard]] const WheelBias& wheel_bias() const { return bias_; }
  /// Weighs both sources: the matches by the errors that the active loops show, the wheels by their distance from the
  /// graph between places.
  void weigh(const PoseGraph& graph);
  /// Multiplies the variances of both sources by this factor.
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
  bool are_wheels_good_ = false;            // loops show good wheels: their own headings count
  std::vector<Matrix3> wheel_information_;  // information of each step with hindsight; empty before
};

}  // namespace gdtslam
