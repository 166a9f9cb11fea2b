// Options of `gdtslam render` that a view or an ending takes no notice of: a mistake, said before anything is drawn.
// Thread-safe.
#pragma once

#include "output.hpp"
#include "tools/gdtslam/pictures/options.hpp"
#include "tools/gdtslam/pictures/views.hpp"

namespace gdtslam {

/// Throws UsageError that names the first option that was given and changes nothing. `view`: null for pages and models.
void refuse_idle_options(const RenderOptions& options, const RenderView* view, OutputKind output);

}  // namespace gdtslam
