// A run as a session that can be joined with others: its keyframes with their scans, and the graph with its closed
// loops. Frame: the run's map. Thread-safe; linear in the keyframes.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/mapping/sites/session.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/keyframes/run_keyframes.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/runs/settings.hpp"

namespace gdtslam {

struct RunSession {
  std::string folder;
  std::string name;              ///< name of the first log
  std::string keyframes_sha256;  ///< identifies the run
  Settings settings;             ///< settings of the run
  Trajectory trajectory;
  std::vector<std::size_t> drives;  ///< first scans of further drives
  RunKeyframes kept;                ///< the keyframes; their scans as ranges
  Session session;                  ///< and as points
  RunFiles files;
};

/// Throws InputError with advice if the folder is no run, its laser nods, it was mapped with --no-loops or by an older
/// version, or its files do not match; FileError.
RunSession read_run_session(const std::string& folder);

/// Gives all runs the widest of their scan.min_range and scan.max_range, and applies each run's own limits to its kept
/// scans. So every reading of a site counts as in its own run.
void share_range_limits(std::vector<RunSession>& runs);

// Scans that two runs share: parts of one log, a run and its edited copy, or a site and a run in it. If such runs are
// joined, the scans count twice, and the paths look more certain than they are. Thread-safe; O(n log n) in all
// keyframes, and keyframes with one stamp are compared in pairs.

/// Two runs by their indices in the list, the smaller first.
struct SharedScans {
  std::size_t first = 0;
  std::size_t second = 0;
  std::size_t keyframes = 0;
};

/// Each pair of runs with a common keyframe, sorted by first and second. Common means the same stamp and number of
/// beams, and the same range to the millimetre if both have a return. Most beams must have one in both, because a merge
/// or an edit removes readings. A scan that a log repeats counts once.
std::vector<SharedScans> shared_scans(const std::vector<const RunKeyframes*>& runs);

}  // namespace gdtslam
