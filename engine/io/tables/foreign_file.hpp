// Files that are given in place of a log, by how they begin. Thread-safe.
#pragma once

#include <string>
#include <string_view>

namespace gdtslam {

/// What a file is whose first line, or first line behind comments, is this one, and what to do: "is a PNG picture, not
/// a log; give ...". Empty if the line is not known.
std::string fault_of_foreign_line(std::string_view line);

/// "; give a CARMEN, CSV, JSON lines, ROS bag or MCAP log".
std::string give_a_log();

}  // namespace gdtslam
