// The sessions of a site as one: their keyframes one after the other, and the graph of all their places. At first each
// session lies where its best fix puts it. Frame: that of the first session. Not thread-safe.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/graph/pose_graph.hpp"
#include "engine/mapping/loops/loop_finder.hpp"
#include "engine/mapping/sites/session.hpp"

namespace gdtslam {

struct SessionEdge;

class SiteGraph {
 public:
  /// `group` has the ascending numbers of the sessions that the edges connect. A session alone stays as it is.
  SiteGraph(const std::vector<std::size_t>& group, const std::vector<Session>& sessions,
            const std::vector<SessionEdge>& edges);
  SiteGraph(const SiteGraph&) = delete;
  SiteGraph& operator=(const SiteGraph&) = delete;

  /// Makes keyframes and places known to the finder, which must not outlive this.
  void show_to(LoopFinder& finder);
  /// Searches at every place once, solves the graph, and moves the keyframes accordingly.
  void close_loops(LoopFinder& finder, WorkerPool& workers, const std::function<void(double)>& progress);

  [[nodiscard]] const std::vector<KeptScan>& scans() const { return scans_; }
  [[nodiscard]] std::vector<Pose2>& poses() { return poses_; }
  /// Relations of the sessions' paths, from keyframe to keyframe and over longer spans, for the joint adjustment.
  [[nodiscard]] std::vector<PoseRelation> held_relations() const;
  /// Number of loops from one session to another that are on, or off.
  [[nodiscard]] std::size_t loops_between(bool is_on) const;
  /// Moves all into the frame of the first session's map: the adjustment moves the first pose slightly too.
  void return_to_frame();
  /// Moves all keyframes into one session, without its graph.
  [[nodiscard]] Session as_one() &&;
  /// Poses of the keyframes by session.
  [[nodiscard]] std::vector<std::vector<Pose2>> poses_of_sessions() const;
  [[nodiscard]] const PoseGraph& graph() const { return graph_; }
  /// Keyframe of each node of the graph, among all keyframes.
  [[nodiscard]] const std::vector<std::size_t>& places() const { return places_; }
  /// Covariance of each keyframe within the site.
  [[nodiscard]] std::vector<Matrix3> covariances() const;

 private:
  struct Part {
    std::size_t session = 0;
    std::size_t first_keyframe = 0;
    std::size_t keyframes = 0;
    std::size_t first_place = 0;
    std::size_t places = 0;
  };
  void add(const Session& session, std::size_t number);
  void lay(const std::vector<Session>& sessions, const std::vector<SessionEdge>& edges);
  void add_edge(const SessionEdge& edge, const std::vector<Session>& sessions, bool is_trusted);
  void carry_keyframes();
  [[nodiscard]] std::size_t part_index(std::size_t session) const;
  [[nodiscard]] const Part& part_of_place(std::size_t place) const;

  std::vector<Part> parts_;
  std::vector<KeptScan> scans_;
  std::vector<Pose2> poses_;
  std::vector<Pose2> shape_;  // the keyframes' poses in their own sessions
  std::vector<double> path_m_;
  std::vector<StepDoubt> doubts_;
  std::vector<std::size_t> places_;  // keyframe of each place
  PoseGraph graph_;
};

}  // namespace gdtslam
