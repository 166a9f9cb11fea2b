// The path as it was measured twice, by the front end and by the wheels alone: which of the two is to be believed, and
// how much, only shows where loops tie the path to itself. Frame: that of the first keyframe. Not thread-safe. Linear
// in the keyframes.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/graph/variance_components.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "engine/mapping/wheels/wheel_bias.hpp"

namespace gdtslam {

/// The pose of a keyframe in the frame of the one before it, by one of the two.
struct MeasuredStep {
  Pose2 T;
  Matrix3 information{};  ///< of the tangent at T
};

enum class StepSource : std::size_t { kFrontEnd = 0, kWheels = 1 };
inline constexpr std::size_t kStepSources = 2;
using MeasuredSteps = std::array<MeasuredStep, kStepSources>;

/// What the front end gives: one entry a keyframe in each.
struct FrontEndPath {
  std::vector<KeptScan> scans;
  std::vector<Pose2> poses;
  std::vector<double> path_m;        ///< travelled until each
  std::vector<MeasuredSteps> steps;  ///< to each from the one before; of the first nothing
};

class MeasuredPath {
 public:
  /// Between places, which are keyframes, ascending; `path` must outlive this.
  MeasuredPath(const FrontEndPath& path, std::vector<std::size_t> places);

  /// One place more, a keyframe behind the last place.
  void add_place(std::size_t keyframe);

  [[nodiscard]] const std::vector<std::size_t>& places() const { return places_; }
  /// From place to place by each of the sources, as much as they are believed now: all of the front end, then all of
  /// the wheels. Factors of the variance below `least_factor` count as that.
  [[nodiscard]] std::vector<PoseRelation> relations(double least_factor = 0.0) const;
  /// To a place from the one before it, as the front end says.
  [[nodiscard]] const PoseRelation& by_front_end(std::size_t place) const { return stated_[0][place - 1]; }
  /// Between two keyframes, as far as the source is believed now.
  [[nodiscard]] PoseRelation stretch(std::size_t from, std::size_t to, StepSource source) const;

  /// Takes from the wheels what they get wrong always, as it shows against keyframes that are known better.
  void correct_wheels(const std::vector<Pose2>& keyframes);
  [[nodiscard]] const WheelBias& wheel_bias() const { return bias_; }
  /// How far each source is to be believed, by what the loops that are on say of it.
  void weigh(const std::vector<Loop>& loops);
  void believe_as_stated() { factors_ = {}; }
  [[nodiscard]] const std::array<VarianceFactor, kStepSources>& factors() const { return factors_; }

 private:
  [[nodiscard]] PoseRelation stated(std::size_t from, std::size_t to, std::size_t source) const;

  void state_between_places(std::size_t source);
  [[nodiscard]] PoseRelation to_place(std::size_t place, std::size_t source) const;

  const FrontEndPath& path_;
  std::vector<std::size_t> places_;
  std::array<std::vector<PoseRelation>, kStepSources> stated_;  // as measured
  std::array<VarianceFactor, kStepSources> factors_;
  WheelBias bias_;
};

}  // namespace gdtslam
