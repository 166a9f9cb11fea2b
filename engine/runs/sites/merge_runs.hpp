// Runs of several drives joined to sites: what `gdtslam merge` does. The folder that it writes has a run folder for
// each site, numbered from 1, with the path of each run in it, and merge.json, which tells what was joined with what,
// why, and what changed meanwhile (docs/formats.md). The same bytes in whatever order the runs are named. One call
// belongs to one thread; it may use more. Cost: docs/howto/merge.md.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/mapping/sites/session_merge.hpp"
#include "engine/runs/sites/site_outcome.hpp"

namespace gdtslam {

struct MergeRequest {
  std::vector<std::string> runs{};  ///< folders
  std::string folder{};             ///< folder of the results; made if need be
  MergeOptions options{};
  bool with_map = true;  ///< the occupancy map, and the pictures of it
  bool with_pictures = true;
  bool replace_foreign_files = false;  ///< files in the folder that no merge wrote are removed, else it is refused
  unsigned threads = 1;                ///< 0: one a processor

  MergeProgress progress{};  ///< the step at work, and the share of it that is done
  std::function<bool()> stop{};
};

/// A run in a site.
struct JoinedRun {
  std::string folder;
  std::string name;
  std::string trajectory_file;  ///< within the folder of the results
  std::size_t scans = 0;
};

struct JoinedSite {
  std::string folder;  ///< whole
  std::vector<JoinedRun> runs;
  std::size_t keyframes = 0;
  std::size_t loops_between = 0;
  std::size_t loops_off = 0;
  std::string map_sha256;
  SiteChanges changes;
};

/// A run that was searched in a site as it was by then.
struct RunSearch {
  std::string query;  ///< folders
  std::vector<std::string> searched_in;
  SessionSearch search;
};

/// Two runs with scans that are the same measurements, as a run and its edited copy have them.
struct SharedRuns {
  std::string run;  ///< folders
  std::string with;
  std::size_t keyframes = 0;  ///< that both have
};

struct MergeOutcome {
  std::vector<JoinedSite> sites;
  std::vector<RunSearch> searches;
  std::vector<SharedRuns> shared;
  std::string report;  ///< the text of merge.json
};

/// Throws InputError, UsageError, FileError, and Error(kInterrupted) where stop() became true; then nothing is written.
MergeOutcome merge_runs(const MergeRequest& request);

}  // namespace gdtslam
