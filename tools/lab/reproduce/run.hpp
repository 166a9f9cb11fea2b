// What `gdtslam reproduce` does: makes the parts that are asked for and not made yet, then writes the report of all
// that are there. One run belongs to one thread and, at a time, to one folder.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "part.hpp"
#include "store.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"

namespace gdtslam::reproduce {

struct Options {
  std::string folder;
  std::vector<std::string> only;  ///< ids; empty: all
  std::string data;               ///< folder of real logs; empty: none
  DeviceOptions device;
  std::string graphics = "auto";
  bool force = false;      ///< parts that are made already, too
  bool keep_runs = false;  ///< the simulated logs and runs stay in DIR/work
  bool quiet = false;
};

/// A part of the list with what is kept of it.
struct PartState {
  const PartInfo* info = nullptr;
  std::optional<KeptPart> kept;  ///< nothing: not made, or of another program or other inputs
  bool is_new = false;           ///< made by this run
};

/// What the report says of the machine.
struct Host {
  std::string version;
  std::string device;
  std::string processor;
  unsigned threads = 1;  ///< of the processor
};

struct Result {
  std::vector<PartState> parts;
  Host host;
  std::string html;  ///< file
  std::string markdown;
  double wall_s = 0.0;  ///< of this run
};

/// The ids of parts by these names, "fig8" or "table1". Throws UsageError with the nearest one.
std::vector<std::string> checked_ids(const std::vector<std::string>& names);

/// The line on a terminal while it works, of the share that is done of what is in hand: "fig8 42 %, fig14 3 %  (3 of
/// 10 parts made, 1:10 min left)".
std::string progress_text(const std::map<std::string, double>& shares, std::size_t made, std::size_t parts,
                          double left_s);

/// Throws every typed error; parts that are finished by then are kept, and the report has them.
Result reproduce(const Options& options);

// The report: one HTML file that needs nothing else, and the same as Markdown with the pictures in the folders of the
// parts. Thread-safe; O(pictures).

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
