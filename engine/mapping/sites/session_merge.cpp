#include "session_merge.hpp"

#include <utility>

#include "engine/mapping/sites/site_graph.hpp"

namespace gdtslam {
namespace {

MergedSite merge_group(const std::vector<std::size_t>& group, const std::vector<Session>& sessions,
                       const std::vector<SessionEdge>& edges, const MergeOptions& options, WorkerPool& workers,
                       const MergeProgress& progress) {
  MergedSite site;
  site.sessions = group;
  SiteGraph graph(group, sessions, edges);
  if (group.size() > 1) {
    LoopFinder finder(options.loops);
    graph.show_to(finder);
    for (int round = 0; round < options.rounds; ++round) {
      graph.close_loops(finder, workers, [&](double share) {
        progress("closing loops between sessions", (share + round) / options.rounds);
      });
    }
    site.searches = finder.counts().searched;
    site.loops_between = graph.loops_between(true);
    site.loops_off = graph.loops_between(false);
    const std::vector<LineScan> scans(graph.scans().begin(), graph.scans().end());
    const auto tell = [&](double share) { progress("adjusting keyframes", share); };
    site.joint =
        JointAdjustment(scans, graph.held_relations(), options.joint).run(graph.poses(), workers, tell, options.device);
    graph.return_to_frame();
  }
  site.poses = graph.poses_of_sessions();
  site.graph = graph.graph();
  site.places = graph.places();
  site.covariances = graph.covariances();
  return site;
}

}  // namespace

MergedSessions merge_sessions(const std::vector<Session>& sessions, const MergeOptions& options, WorkerPool& workers,
                              const MergeProgress& progress) {
  GrownSites grown = grow_sites(sessions, options.overlap, workers, progress);
  MergedSessions merged{.searches = std::move(grown.searches), .edges = std::move(grown.edges), .sites = {}};
  for (const std::vector<std::size_t>& group : grown.groups) {
    merged.sites.push_back(merge_group(group, sessions, merged.edges, options, workers, progress));
  }
  return merged;
}

}  // namespace gdtslam
