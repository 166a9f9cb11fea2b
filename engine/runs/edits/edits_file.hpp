// edits.json of an edited run: its steps, so that they can be done again (docs/formats.md). Thread-safe; O(text).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/edits/edit_steps.hpp"

namespace gdtslam {

struct RecordedEdits {
  std::string run;              ///< the folder that was edited, as it was named
  double begins_at_s = 0.0;     ///< stamp of the first pose of the run: who has another has another frame
  std::vector<EditStep> steps;  ///< from the first edit of a run that `map` or `merge` wrote
};

/// `readings` were taken out by the last edit.
std::string edits_text(const RecordedEdits& edits, std::size_t readings);

/// `name` stands in messages. Throws InputError with the step that is wrong and what to do.
RecordedEdits parse_edits(std::string_view text, const std::string& name);
/// Throws FileError too.
RecordedEdits read_edits(const std::string& file);

}  // namespace gdtslam
