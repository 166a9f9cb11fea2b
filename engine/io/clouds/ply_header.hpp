// The header of a PLY file [Turk1994].
#pragma once

#include "cloud_file_layout.hpp"
#include "cloud_input.hpp"

namespace gdtslam {

struct PlyHeader {
  CloudFormat format = CloudFormat::kPlyBinary;
  bool is_big_endian = false;
  std::vector<CloudElement> elements;  ///< in the order of the file
};

/// Reads from behind the first line, "ply", to behind "end_header". Throws InputError with the line.
PlyHeader read_ply_elements(CloudInput& input);
/// The same as the layout of a cloud; InputError also where there are no vertices.
CloudFileLayout read_ply_header(CloudInput& input);

}  // namespace gdtslam
