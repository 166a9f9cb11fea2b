// Messages of VTK. From the first GraphicsContext on none of them reaches the terminal: errors are kept for the thread
// that caused them until a view asks for them; warnings are dropped.
#pragma once

#include <string>
#include <vector>

namespace gdtslam {

/// Takes the place of VTK's own output, and ends its log of events, once in a process.
void collect_vtk_messages();

/// One line for each error that came up in this thread since the last call.
std::vector<std::string> take_vtk_errors();

}  // namespace gdtslam
