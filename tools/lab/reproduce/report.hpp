// The report of `gdtslam reproduce`: one HTML file that needs nothing else, and the same as Markdown with the pictures
// in the folders of the parts. Thread-safe; O(pictures).
#pragma once

#include <string>
#include <string_view>

#include "run.hpp"

namespace gdtslam::reproduce {

/// Throws FileError where a picture cannot be read.
std::string html_of(const Result& result, const Store& store);
std::string markdown_of(const Result& result);

// What both say.
inline constexpr std::string_view kAbout =
    "The figures and tables of \u201cA Robotic Indoor 3D Mapping System Using a 2D Laser Range Finder Mounted on a "
    "Rotating Four-Bar Linkage of a Mobile Platform\u201d made anew by gdtslam, with the paper\u2019s numbers beside "
    "ours.";
inline constexpr std::string_view kNotPublished =
    "The paper\u2019s logs are not published. Everything here is simulated, or computed from what the paper prints, "
    "unless a part says that it is real.";
inline constexpr std::string_view kVerdicts =
    "Within: what the paper claims holds here, by the rule in the remark. Outside: it does not. No verdict: the paper "
    "gives no number, or none that can be held against ours.";

struct VerdictCounts {
  std::size_t within = 0;
  std::size_t outside = 0;
  std::size_t open = 0;
};
VerdictCounts counts_of(const Result& result);
/// "gdtslam reproduce -o DIR --only fig3".
std::string command_of(const PartInfo& info);
/// CPU time that the parts took when they were made.
double cpu_s_of_parts(const Result& result);
/// "12.3 s", "2:05 min".
std::string seconds_text(double seconds);
std::size_t parts_made(const Result& result);

}  // namespace gdtslam::reproduce
