// The header of a PLY file [Turk1994].
#pragma once

#include "cloud_input.hpp"
#include "cloud_layout.hpp"

namespace gdtslam {

/// Reads from behind the first line, "ply", to behind "end_header". Throws InputError with the line.
CloudLayout read_ply_header(CloudInput& input);

}  // namespace gdtslam
