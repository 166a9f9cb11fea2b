// The map of a run made anew from its keyframes alone, without its log. Frame: map. Thread-safe; some 0.5 ms a
// keyframe.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "engine/mapping/map/keyframe_map.hpp"
#include "engine/runs/keyframes/keyframe_file.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam {

/// Merges the keyframes in their order at their poses, paper equations (1) and (9) to (11). `config` is that of the
/// run. Where the log gave ranges in whole millimetres this is the run's distance field, bit for bit; else points lie
/// up to half a millimetre away, and cells differ by some millimetres (docs/formats.md). A return within half a
/// millimetre of scan.min_range or scan.max_range may count where it did not, or not where it did. Throws InputError
/// where the map would be beyond map.max_megacells.
std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, const MapperConfig& config);
/// Of some of them alone, by their places in the run, ascending.
std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, std::span<const std::size_t> which,
                                              const MapperConfig& config);

}  // namespace gdtslam
