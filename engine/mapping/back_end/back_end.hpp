// Turns the path of the front end into the final path: loops are closed, all keyframes are adjusted together, then
// every scan. Frame: the robot's pose at the first scan. Not thread-safe; the result is the same for any number of
// threads. Cost: docs/loops.md; in memory 20 bytes a point of a keyframe, at a place that was passed often only for
// some (PlacePruning). The points of all scans, the keyframe of each, and the measurements between keyframes wait on
// shelves.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/adjust/joint_adjustment.hpp"
#include "engine/mapping/adjust/scan_adjustment.hpp"
#include "engine/mapping/back_end/match_chain.hpp"
#include "engine/mapping/loops/live_loops.hpp"
#include "engine/mapping/wheels/continued_motion.hpp"
#include "engine/mapping/wheels/known_surfaces.hpp"
#include "engine/mapping/wheels/turn_leap.hpp"
#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

struct BackEndOptions {
  LoopOptions loops;
  LiveOptions live{};
  JointOptions joint;
  ScanAdjustmentOptions scans;
  BatchDevice device{};          ///< of the adjustments
  unsigned threads = 1;          ///< threads of the adjustments, the caller's included; 0: one a processor
  std::string scratch_folder{};  ///< folder for the shelves' files
  std::size_t shelf_bytes = ByteShelf::kMemoryBytes;  ///< memory of the shelf that holds the points
};

/// Result of the back end.
struct BackEndResult {
  bool is_closed = false;              ///< else the path as it was driven
  std::vector<Pose2> poses;            ///< one a scan taken
  std::vector<Matrix3> covariances;    ///< covariances of (x, y, theta) along the map's axes, one a scan taken
  std::vector<std::size_t> keyframes;  ///< numbers of the scans that are keyframes
  PoseGraph graph;                     ///< pose graph of the places
  std::vector<std::size_t> places;     ///< keyframe of each place
  std::array<VarianceFactor, kStepSources> factors;  ///< factors of the variances of matches and wheels
  WheelBias wheels;
  LoopCounts counts;
  JointResult joint;
};

class BackEnd {
 public:
  /// Receives the name of the step that runs and its finished share, 0 to 1.
  using Progress = std::function<void(std::string_view, double)>;

  explicit BackEnd(const BackEndOptions& options);

  /// Takes the next scan and the front end's pose of it. Rethrows exceptions of the search for loops.
  void take(const KeptScan& scan, const MatchResult& result);

  /// Call it once, after the last scan.
  BackEndResult finish(const Progress& progress);
  /// The path of the front end; ends the search for loops.
  [[nodiscard]] BackEndResult as_driven();
  /// The loops found so far.
  [[nodiscard]] LiveLoops& loops() { return loops_; }
  [[nodiscard]] const LiveLoops& loops() const { return loops_; }
  /// After the end: the keyframes that were adjusted together, by their number, ascending; at a place that was passed
  /// often not all keyframes are among them (PlacePruning).
  [[nodiscard]] const std::vector<std::size_t>& kept() const { return kept_; }
  /// After the end: visits all keyframes in order. Throws FileError if the shelf cannot be read.
  void visit_keyframes(const std::function<void(std::size_t keyframe, const KeptScan& scan)>& visit) const;

 private:
  /// A scan's pose in the frame of its keyframe.
  struct Scan {
    Pose2 T_keyframe_base;
    std::size_t keyframe = 0;
  };
  void follow(const MatchResult& result);
  void add_keyframe(const MatchResult& result, KeptScan points);
  [[nodiscard]] MeasuredSteps steps_to(const MatchResult& result, const KeptScan& known) const;
  Matrix3 update_unseen(const MatchResult& result, const KeptScan& known);
  void take_kept();
  JointResult adjust_keyframes(const LoopCloser& closer, std::vector<Pose2>& keyframes, WorkerPool& workers,
                               const Progress& progress) const;
  [[nodiscard]] std::vector<Pose2> poses_of_scans(const std::vector<Pose2>& keyframes) const;
  struct CautiousGraph {
    PoseGraph graph;
    std::vector<std::size_t> keyframes;  // keyframes at its nodes
  };
  [[nodiscard]] CautiousGraph cautious_graph(const LoopCloser& closer) const;
  [[nodiscard]] std::vector<Matrix3> covariances_of_scans(const LoopCloser& closer) const;
  void warn_of_shelf() const;
  void adjust_scans(const std::vector<Pose2>& keyframes, std::vector<Pose2>& poses, WorkerPool& workers,
                    const Progress& progress) const;

  BackEndOptions options_;
  LiveLoops loops_;
  PlaceCounter counter_;
  const FrontEndPath& path_ = loops_.path();  // path of the keyframes; read after the end
  Shelf<Scan> scans_;
  std::size_t keyframes_taken_ = 0;
  Pose2 T_map_keyframe_;      // last keyframe
  double travelled_m_ = 0.0;  // path length up to it
  double stretch_m_ = 0.0;    // since the local map began
  KnownSurfaces known_;
  MatchChain chain_;
  Matrix3 covariance_ = Matrix3::diagonal(1.0e-6, 1.0e-6, 1.0e-7);  // covariance of the last keyframe in the local map
  // Since the last keyframe, in the frame of the last scan:
  Pose2 T_wheels_;  // by the wheels alone
  Matrix3 wheels_covariance_;
  Matrix3 leaps_;        // covariance of disagreements between wheels and matches, for the wheels
  Matrix3 match_leaps_;  // and for the matches
  TurnLeap turn_leap_;
  WheelTravel travel_;
  Shelf<KeptScan> shelf_;  // points of all scans
  // After the end:
  std::vector<std::size_t> keyframes_;  // numbers of the scans that are keyframes
  std::vector<std::size_t> kept_;       // keyframes
  std::vector<LineScan> kept_scans_;    // scans of the kept keyframes, until all is adjusted
};

}  // namespace gdtslam
