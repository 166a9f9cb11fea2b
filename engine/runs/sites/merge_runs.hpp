// Joins runs of several drives to sites; the work of `gdtslam merge`. The written folder has a run folder for each
// site, numbered from 1, with the path of each run in it. merge.json states which runs were joined, why, and what
// changed meanwhile (docs/formats.md). The order of the runs does not change a byte. One call belongs to one thread; it
// may use more. Cost: docs/howto/merge.md.
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
  bool with_map = true;  ///< the occupancy map and its pictures
  bool with_pictures = true;
  bool replace_foreign_files = false;  ///< foreign files in the folder are removed; otherwise the folder is refused
  unsigned threads = 1;                ///< 0: one for each processor

  MergeProgress progress{};  ///< the current step and the share of it that is done
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

/// A search of a run in a site as it was at that time.
struct RunSearch {
  std::string query;  ///< folders
  std::vector<std::string> searched_in;
  SessionSearch search;
};

/// Two runs that share scans, such as a run and its edited copy.
struct SharedRuns {
  std::string run;  ///< folders
  std::string with;
  std::size_t keyframes = 0;  ///< keyframes that both have
};

struct MergeOutcome {
  std::vector<JoinedSite> sites;
  std::vector<RunSearch> searches;
  std::vector<SharedRuns> shared;
  std::string report;  ///< the text of merge.json
};

/// Throws InputError, UsageError, FileError, and Error(kInterrupted) if stop() became true; then nothing is written.
MergeOutcome merge_runs(const MergeRequest& request);

}  // namespace gdtslam
