// Options of `gdtslam evaluate`, and a function for each kind of input. Thread-safe apart from the files.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "engine/runs/evaluation/errors.hpp"
#include "engine/runs/evaluation/measure_table.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "tools/gdtslam/shell/cli.hpp"

namespace gdtslam {

struct MeasureOptions {
  MeasureJob job;
  PlaneSearch search;            ///< thickness of planes and of the faces of boxes
  double gap_m = 0.0;            ///< 0: the search's default
  std::uint32_t min_points = 0;  ///< 0: the search's default
  std::string viewpoint;
  std::string picture;
};

struct EvaluateOptions {
  std::string file;  ///< a run, a trajectory, a table of `localize`, or a cloud
  std::string relations;
  std::string reference;      ///< truth of a cloud or a table: with `trajectory`, else in the same frame
  double tolerance_s = -1.0;  ///< negative: the default
  double distance_m = ReferenceOptions{}.rpe_distance_m;
  bool no_align = false;
  std::string noise;       ///< noise of the truth, "2cm/0.5deg"; empty: none
  std::string trajectory;  ///< path of the run that made the cloud, or map of the poses
  std::string csv;
  bool force = false;
  bool json = false;
  // Options for a table of `localize`:
  std::string within;         ///< "10cm/1deg"; empty: that value
  double leave_out_s = -1.0;  ///< negative: no scan is left out
  // Options for a cloud:
  std::string scene;       ///< either this or hits
  std::string hits;        ///< file of true hits
  std::string linkage;     ///< with hits: for the quantisation bound
  std::string resolution;  ///< step of the ranges, a length; with linkage
  MeasureOptions measure;
};

/// Options of matching stamps and aligning trajectories.
ReferenceOptions reference_options(const EvaluateOptions& options);

/// Alignment of --trajectory, or of the evaluated run, to the reference.
CloudFrame align_cloud(const EvaluateOptions& options);
std::string frame_text(const CloudFrame& frame, const std::string& what, bool no_align);
nlohmann::ordered_json frame_json(const CloudFrame& frame);

/// Parses "2cm/0.5deg" as length and angle; `option` and `example` appear in error messages. Throws UsageError.
struct LengthAndAngle {
  double length_m = 0.0;
  double angle_rad = 0.0;
};
LengthAndAngle length_and_angle(const std::string& option, const std::string& text, const std::string& example);

/// Heading of the error columns, and one of their rows.
std::string errors_heading();
std::string errors_row(const std::string& name, const ErrorSummary& errors, const std::string& unit);
nlohmann::ordered_json errors_json(const ErrorSummary& errors);
std::string stated_text(const StatedReport& report, const TruthNoise& noise);
nlohmann::ordered_json stated_json(const StatedReport& report, const TruthNoise& noise);

/// Adds the options of --boxes and --planes.
void add_measure_options(CLI::App& command, MeasureOptions& chosen);

// Each prints its result and returns the exit code. Throws UsageError, InputError, FileError, and errors of the truth's
// readers.
int evaluate_trajectory(const EvaluateOptions& options);
int evaluate_cloud(const EvaluateOptions& options);
int evaluate_poses(const EvaluateOptions& options);
int measure_boxes_and_planes(const EvaluateOptions& options);

}  // namespace gdtslam
