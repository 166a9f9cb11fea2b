// What VTK would print. From the first GraphicsContext on nothing of VTK reaches the terminal: errors and warnings are
// kept for the thread in which they came up, until a view asks for them.
#pragma once

#include <string>
#include <vector>

namespace gdtslam {

/// Takes the place of VTK's own output, once in a process.
void collect_vtk_messages();

struct VtkMessages {
  std::vector<std::string> errors;    ///< one line each
  std::vector<std::string> warnings;  ///< one line each
};
/// What came up in this thread since the last call.
VtkMessages take_vtk_messages();

}  // namespace gdtslam
