// The report of `gdtslam reproduce`: one HTML file that needs nothing else, and the same as Markdown with the pictures
// in the folders of the parts. Thread-safe; O(pictures).
#pragma once

#include <string>

#include "reproduce_run.hpp"

namespace gdtslam::reproduce {

/// Throws FileError where a picture cannot be read.
std::string html_of(const Result& result, const Store& store);
std::string markdown_of(const Result& result);

/// What both say.
struct VerdictCounts {
  std::size_t within = 0;
  std::size_t outside = 0;
  std::size_t open = 0;
};
VerdictCounts counts_of(const Result& result);
/// "gdtslam reproduce -o DIR --only fig3".
std::string command_of(const PartInfo& info);
/// Seconds that the parts took when they were made.
double seconds_of_parts(const Result& result);
/// "12.3 s", "2:05 min".
std::string seconds_text(double seconds);
std::size_t parts_made(const Result& result);

}  // namespace gdtslam::reproduce
