// What the fuzzer of edits.json calls. A typed error is a right answer; a crash, a leak, a hang or any other exception
// is not. tests/unit/tools replays the corpus.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

#include "engine/runs/edits/edits_file.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::fuzz {

inline void read_edits_text(std::span<const std::byte> data) {
  const auto require = [](bool holds) {
    if (!holds) std::abort();
  };
  try {
    const RecordedEdits edits = parse_edits({reinterpret_cast<const char*>(data.data()), data.size()}, "fuzz");
    const EditPlan plan = plan_of(edits.steps);
    require(plan.T_edited_run.is_finite() && (!plan.T_world_edited || plan.T_world_edited->is_finite()));
    for (const MapRegion& region : plan.erased) require(region.corners_m.size() >= 3);
    for (const MapRegion& region : plan.kept) require(region.corners_m.size() == 4);
    const std::string written = edits_text(edits, 0);
    require(edits_text(parse_edits(written, "written"), 0) == written);
  } catch (const InputError& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
}

}  // namespace gdtslam::fuzz
