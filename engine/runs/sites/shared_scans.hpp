// Scans that two runs have both, as parts of one log, a run and its edited copy, or a site and a run that is in it.
// What they saw counts twice where the runs are joined, and their paths look more certain than they are. Thread-safe;
// O(n log n) in all keyframes, and of those with one stamp each of a run is held against each of the others.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/runs/keyframes/keyframe_file.hpp"

namespace gdtslam {

/// Of two runs, by their places in the list, the first smaller.
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
