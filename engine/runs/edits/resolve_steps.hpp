// The steps of an edit with their numbers: what was asked for, and what a run itself says of it. Thread-safe.
#pragma once

#include <vector>

#include "engine/runs/edits/edit_run.hpp"
#include "engine/runs/edits/source_run.hpp"

namespace gdtslam {

/// Nothing where they go together. Throws UsageError.
void check_request(const EditRequest& request);

/// Those of `again` first. Throws InputError where its steps are of a run that begins at another time, or the run was
/// edited already; where points contradict each other or walls have no direction; and as UsageError where there is no
/// step at all, or none that tells where north is.
std::vector<EditStep> resolved_steps(const EditRequest& request, const SourceRun& run);

}  // namespace gdtslam
