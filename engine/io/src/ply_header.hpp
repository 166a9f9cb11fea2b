// The header of a PLY file [Turk1994].
#pragma once

#include "cloud_file_layout.hpp"
#include "cloud_input.hpp"

namespace gdtslam {

/// Reads from behind the first line, "ply", to behind "end_header". Throws InputError with the line.
CloudFileLayout read_ply_header(CloudInput& input);

}  // namespace gdtslam
