// One part of the report of `gdtslam reproduce`: a figure or table of the paper made anew, with the paper's numbers
// beside ours. A part is made in a folder of its own and kept there, so that it need not be made again. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "tools/gdtslam/pictures/options.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"

namespace gdtslam::reproduce {

class Drives;

enum class Verdict : std::uint8_t {
  kWithin,   ///< what the paper claims holds here, by the rule that the remark states
  kOutside,  ///< it does not
  kOpen      ///< the paper gives no number, or one that cannot be held against ours
};
constexpr Verdict verdict_of(bool holds) { return holds ? Verdict::kWithin : Verdict::kOutside; }
/// "within", "outside", "no verdict".
std::string_view to_string(Verdict verdict);

/// Where a part's data come from.
enum class Origin : std::uint8_t { kComputed, kSimulated, kSimulatedAndReal };
/// "computed", "simulated", "simulated and real".
std::string_view to_string(Origin origin);

/// One number of the paper beside ours; all as text with units.
struct Row {
  std::string quantity;
  std::string paper;  ///< empty: the paper gives none
  std::string ours;
  Verdict verdict = Verdict::kOpen;
  std::string remark;
};

struct Picture {
  std::string file;  ///< in the part's folder, .svg or .png
  std::string caption;
  int across = 1;  ///< so many stand side by side: 1, 2 or 3
};

struct Table {
  std::string caption;
  std::vector<std::string> heads;
  std::vector<std::vector<std::string>> rows;
};

/// What making a part gave.
struct Part {
  Origin origin = Origin::kSimulated;
  std::string source;  ///< one sentence: from which numbers, scene and seed, or log
  std::vector<Picture> pictures;
  std::vector<Row> rows;
  std::vector<Table> tables;
  std::vector<std::string> notes;
  std::vector<std::string> by_hand;  ///< the same step by step, with the ordinary commands

  /// A row with the paper's verdict: its claim holds here or it does not.
  void claim(std::string quantity, std::string paper, std::string ours, bool holds, std::string remark);
  /// A row without a verdict.
  void state(std::string quantity, std::string paper, std::string ours, std::string remark);
};

/// What a part is made with. Nothing in it is owned.
struct PartContext {
  std::string folder;  ///< for its pictures; exists
  Drives& drives;
  DeviceOptions device;
  std::string data;                      ///< folder of the real logs; empty: none
  std::function<void(double)> progress;  ///< share of the part that is done
  std::function<bool()> stop;
};

/// One row of the list of parts.
struct PartInfo {
  std::string_view id;                     ///< "fig3"
  std::string_view also{};                 ///< another name of it, "table1"; empty: none
  std::string_view label{};                ///< "Figure 3"
  std::string_view title{};                ///< what it shows here
  std::string_view paper{};                ///< what it shows in the paper, in our words
  double weight_s = 1.0;                   ///< CPU seconds as measured, for the time left
  std::vector<std::string_view> drives{};  ///< that it uses, by name
  double data_weight_s = 0.0;              ///< likewise, for the real logs where it takes them in; 0: it does not
  Part (*make)(const PartContext&) = nullptr;
};

/// All parts in the order of the report.
const std::vector<PartInfo>& part_list();

/// Throws Error(kInterrupted) where the work is to stop.
void go_on(const PartContext& place);

/// Writes the drawing under that name (.svg, or .png of `scale` pixels for each of the drawing) and adds it.
void add_picture(Part& part, const PartContext& place, const Canvas& drawing, Picture picture, double scale = 1.0);

/// A white sheet with its title and a line of words above what is to be drawn.
Canvas titled_sheet(double width, double height, const std::string& title, const std::string& words);

/// A view of `gdtslam render` of these inputs, drawn as that command draws it.
struct ViewOrder {
  std::vector<std::string> inputs;
  std::string view;
  std::string size;  ///< empty: the view's own
  RenderOptions options{};
};
void add_view(Part& part, const PartContext& place, const ViewOrder& order, Picture picture);

/// "4.00 mm", "1.23 cm", "2.50 m": a length in the unit that reads best.
std::string length_with_unit(double length_m);

// The makers, each in a file of its own.
Part make_cells(const PartContext& place);
Part make_local_scan(const PartContext& place);
Part make_loop(const PartContext& place);
Part make_optimizer_errors(const PartContext& place);
Part make_optimizer_positions(const PartContext& place);
Part make_linkages(const PartContext& place);
Part make_boxes(const PartContext& place);
Part make_standing(const PartContext& place);
Part make_floor_3f(const PartContext& place);
Part make_floor_7f(const PartContext& place);
Part make_calibration(const PartContext& place);

}  // namespace gdtslam::reproduce
