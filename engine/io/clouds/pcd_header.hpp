// The header of a PCD file, version 0.7 and those before it.
#pragma once

#include <string>

#include "cloud_file_layout.hpp"
#include "cloud_input.hpp"

namespace gdtslam {

/// Reads to behind the line DATA; `first_line` has been read already. Throws InputError with the line.
CloudFileLayout read_pcd_header(CloudInput& input, const std::string& first_line);

}  // namespace gdtslam
