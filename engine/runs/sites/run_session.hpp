// A run as a session that can be joined with others: its keyframes with their scans, and the graph in which its loops
// were closed. Frame: the run's map. Thread-safe; linear in the keyframes.
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
  std::string keyframes_sha256;  ///< tells it from others
  Settings settings;             ///< that it was mapped with
  Trajectory trajectory;
  std::vector<std::size_t> drives;  ///< scans at which another drive begins
  RunKeyframes kept;                ///< the keyframes; their scans as ranges
  Session session;                  ///< and as points
  RunFiles files;
};

/// Throws InputError, with what to do, where the folder is no run, its laser nods, it was mapped with --no-loops or by
/// an older version, or its files do not belong together; FileError.
RunSession read_run_session(const std::string& folder);

/// Gives all runs the widest of their scan.min_range and scan.max_range, and each kept scan the limits of its own run
/// in its place: of a site every reading counts as it did where it was mapped.
void share_range_limits(std::vector<RunSession>& runs);

// Scans that two runs have both, as parts of one log, a run and its edited copy, or a site and a run that is in it.
// What they saw counts twice where the runs are joined, and their paths look more certain than they are. Thread-safe;
// O(n log n) in all keyframes, and of those with one stamp each of a run is held against each of the others.

/// Two runs, by their places in the list, the first smaller.
struct SharedScans {
  std::size_t first = 0;
  std::size_t second = 0;
  std::size_t keyframes = 0;
};

/// Each pair with a keyframe in common: the same stamp, as many beams, and the same range to the millimetre wherever
/// both have a return, which most beams have: a merge or an edit takes readings out. By first and second. A run whose
/// log repeats a stamp with the same ranges has that scan once.
std::vector<SharedScans> shared_scans(const std::vector<const RunKeyframes*>& runs);

}  // namespace gdtslam
