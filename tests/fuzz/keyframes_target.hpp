// What the fuzzer of keyframes calls: the bytes within the packing and before the checksum, which it could not guess. A
// typed error is a right answer; a crash, a leak, a hang or any other exception is not. tests/unit/tools replays the
// corpus.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

#include "engine/runs/keyframes/keyframe_file.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::fuzz {

inline void read_keyframes(std::span<const std::byte> data) {
  const auto require = [](bool holds) {
    if (!holds) std::abort();
  };
  try {
    const RunKeyframes run = parse_keyframes({reinterpret_cast<const char*>(data.data()), data.size()}, "fuzz");
    std::size_t beams = 0;
    for (const RunKeyframe& keyframe : run.keyframes) {
      require(keyframe.T_map_base.is_finite() && std::isfinite(keyframe.laser.stamp_s));
      for (const float range_m : keyframe.laser.ranges_m) require(range_m > 0.0F);
      beams += keyframe.laser.ranges_m.size();
    }
    require(beams < data.size());
    const std::string written = keyframe_bytes(run);
    require(keyframe_bytes(parse_keyframes(written, "written")) == written);
  } catch (const InputError& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
}

}  // namespace gdtslam::fuzz
