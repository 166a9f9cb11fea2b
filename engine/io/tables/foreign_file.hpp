// Files that are given in place of a log, by how they begin. Thread-safe.
#pragma once

#include <string>
#include <string_view>

namespace gdtslam {

/// The kind of a file, by its first line or the first behind comments, and what to do: "is a PNG picture, not a log;
/// give ...". Empty if the line is not known.
std::string fault_of_foreign_line(std::string_view line);

/// "; give a CARMEN, CSV, JSON lines, ROS bag or MCAP log".
std::string give_a_log();

}  // namespace gdtslam
