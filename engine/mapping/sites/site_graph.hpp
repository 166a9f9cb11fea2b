// The sessions of a site as one: their keyframes one after the other, and the graph of all their places, which begins
// with each session laid where its best fix has it. Frame: that of the first session. Not thread-safe.
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
  /// `group` has the numbers of the sessions, ascending, which the edges connect. A session alone stays as it is.
  SiteGraph(const std::vector<std::size_t>& group, const std::vector<Session>& sessions,
            const std::vector<SessionEdge>& edges);
  SiteGraph(const SiteGraph&) = delete;
  SiteGraph& operator=(const SiteGraph&) = delete;

  /// Makes keyframes and places known to the finder, which must not outlive this.
  void show_to(LoopFinder& finder);
  /// Looks at every place once, solves the graph, and moves the keyframes to where it has them.
  void close_loops(LoopFinder& finder, WorkerPool& workers, const std::function<void(double)>& progress);

  [[nodiscard]] const std::vector<KeptScan>& scans() const { return scans_; }
  [[nodiscard]] std::vector<Pose2>& poses() { return poses_; }
  /// Relations of the sessions along the path, from keyframe to keyframe and over some more, for the joint adjustment.
  [[nodiscard]] std::vector<PoseRelation> held_relations() const;
  /// Loops from one session to another that are on, or off.
  [[nodiscard]] std::size_t loops_between(bool is_on) const;
  /// Moves all into the frame of the first session's map: the adjustment moves the first pose too, by as little as any.
  void return_to_frame();
  /// All as one session, without its graph; nothing is left here.
  [[nodiscard]] Session as_one() &&;
  /// By session.
  [[nodiscard]] std::vector<std::vector<Pose2>> poses_of_sessions() const;
  [[nodiscard]] const PoseGraph& graph() const { return graph_; }
  /// Which of all keyframes the nodes of the graph are.
  [[nodiscard]] const std::vector<std::size_t>& places() const { return places_; }
  /// How sure each keyframe is within the site.
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
  std::vector<Pose2> shape_;  // the keyframes as each session had them
  std::vector<double> path_m_;
  std::vector<StepDoubt> doubts_;
  std::vector<std::size_t> places_;  // which keyframes they are
  PoseGraph graph_;
};

}  // namespace gdtslam
