#include "source.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/core/side_thread.hpp"
#include "engine/io/did_you_mean.hpp"
#include "engine/io/message_text.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/localizer/map_field.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/io/map_files.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostPoints = 200'000'000;
constexpr std::size_t kPointsAtOnce = 1U << 16U;
constexpr std::uint64_t kFewestPointBytes = 6;  // "1 2 3" and the end of the line
constexpr double kFarthest_m = 1e6;
constexpr const char* kCloudName = "cloud.ply";
constexpr const char* kTrajectoryName = "trajectory.tum";

bool has_file(const std::string& folder, const char* name) {
  std::error_code ignored;
  return fs::is_regular_file(fs::path(folder) / name, ignored);
}

std::string in_folder(const std::string& folder, const char* name) { return (fs::path(folder) / name).string(); }

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const calib::LinkagePreset& preset : calib::linkage_presets()) names.emplace_back(preset.name);
  return names;
}

bool is_preset(const std::string& name) {
  for (const std::string& preset : preset_names()) {
    if (preset == name) return true;
  }
  return false;
}

// The beginning of a file, decompressed.
std::string read_head(const std::string& path) {
  constexpr std::size_t kHeadBytes = 65536;
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(::gzopen(path.c_str(), "rb"), ::gzclose);
  if (!file) throw FileError(path, "cannot be opened: " + errno_text(errno));
  std::string head(kHeadBytes, '\0');
  const int count = ::gzread(file.get(), head.data(), static_cast<unsigned>(head.size()));
  head.resize(count > 0 ? static_cast<std::size_t>(count) : 0);  // damage is reported when the file is read in full
  return head;
}

// Whether a line of the text begins with the word.
bool has_line(std::string_view text, std::string_view word) {
  for (std::size_t begin = 0; begin < text.size();) {
    if (text.substr(begin).starts_with(word)) return true;
    const std::size_t end = text.find('\n', begin);
    if (end == std::string_view::npos) return false;
    begin = end + 1;
  }
  return false;
}

// Whether the first line that is not a comment has eight numbers: stamp, position and rotation.
bool is_tum(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || line[0] == '#' || line == "\r") continue;
    int numbers = 0;
    const char* at = line.c_str();
    for (char* next = nullptr; std::strtod(at, &next), next != at; at = next) ++numbers;
    return numbers == 8 && std::strspn(at, " \t\r") == std::strlen(at);
  }
  return false;
}

RenderKind kind_of_file(const std::string& path) {
  const std::string head = read_head(path);
  if (head.starts_with("ply\n") || head.starts_with("ply\r") || head.starts_with("# .PCD") ||
      head.starts_with("VERSION")) {
    return RenderKind::kCloud;
  }
  if (has_line(head, "gdtslam_linkage:")) return RenderKind::kLinkage;
  if (has_line(head, "image:")) return is_occupancy_map(path) ? RenderKind::kMap : RenderKind::kField;
  const bool is_picture = head.starts_with("\x89PNG") || head.starts_with("P5") || head.starts_with("P2");
  if (is_picture) {
    throw InputError({path, 0}, "is a picture; give the .yaml beside it, or the folder of the run");
  }
  if (has_line(head, "gdtslam_scene:")) {
    throw InputError({path, 0}, "is a scene; 'gdtslam simulate' makes a log of it, which can be rendered");
  }
  if (is_tum(head)) return RenderKind::kTrajectory;
  throw InputError({path, 0},
                   "is not a run, a cloud, a linkage, a map's .yaml or a trajectory; if it is a log, map it first: "
                   "gdtslam map LOG -o DIR, then gdtslam render DIR");
}

// False also for points that are not finite.
bool is_near(const CloudPoint& point) {
  const auto is_within = [](double value_m) { return value_m >= -kFarthest_m && value_m <= kFarthest_m; };
  return is_within(point.x_m) && is_within(point.y_m) && is_within(point.z_m);
}

// "cloud" from "out/cloud.ply.gz".
std::string file_stem(const std::string& path) {
  fs::path name = fs::path(path).filename();
  if (name.extension() == ".gz") name = name.stem();
  return name.stem().string();
}

struct PointsRead {
  std::uint64_t read = 0;
  std::uint64_t near = 0;  ///< points that can be drawn
};
// Throws InputError if no point can be drawn.
void report_strays(const std::string& path, const CloudReader& reader, const PointsRead& points,
                   const std::function<void(const std::string&)>& remark) {
  const auto& [read, near] = points;
  if (read == 0 && reader.skipped() == 0) throw InputError({path, 0}, "has no points to draw");
  const std::uint64_t strays = reader.skipped() + read - near;
  const std::string which = "not finite or more than 1000 km from the origin";
  if (near == 0) {
    throw InputError({path, 0}, fmt::format("all of its points are {}; move the origin to the cloud", which));
  }
  if (remark && reader.origin_m() != std::array<double, 3>{}) {
    remark(origin_text(path, reader.origin_m()));
  }
  if (strays > 0 && remark) {
    remark(fmt::format("{}: {} left out, {}", path, strays == 1 ? "1 point is" : fmt::format("{} points are", strays),
                       which));
  }
}

}  // namespace

std::string_view to_string(RenderKind kind) {
  constexpr std::array<std::string_view, 6> kNames{"a run", "a cloud",          "a linkage",
                                                   "a map", "a distance field", "a trajectory"};
  return kNames[static_cast<std::size_t>(kind)];
}

RenderKind kind_of_input(const std::string& input) {
  std::error_code failed;
  const fs::file_status status = fs::status(input, failed);
  if (fs::is_directory(status)) {
    if (RunReader::is_run(input)) return RenderKind::kRun;
    if (has_file(input, kCloudName)) return RenderKind::kCloud;
    throw InputError({input, 0},
                     "is a folder without report.json, so no run of 'gdtslam map', and has no cloud.ply; give a run, a "
                     "cloud, a linkage, a map's .yaml or a trajectory");
  }
  if (fs::is_regular_file(status)) return kind_of_file(input);
  if (fs::exists(status)) throw InputError({input, 0}, "is neither a file nor a folder");
  if (is_preset(input)) return RenderKind::kLinkage;
  throw FileError(input, "there is no such file, folder or linkage preset" + did_you_mean(input, preset_names()));
}

RenderSource::RenderSource(std::string input)
    : input_(std::move(input)), name_(file_stem(input_)), kind_(kind_of_input(input_)) {
  switch (kind_) {
    case RenderKind::kRun:
      run_.emplace(input_);
      name_ = run_->name();
      parts_ =
          (run_->summary().map ? part::kMap : 0U) | part::kField | (run_->has_trajectory() ? part::kTrajectory : 0U);
      if (run_->summary().has_loops && run_->has_trajectory()) {
        parts_ |= part::kGraph | (run_->summary().drives.empty() ? part::kReplay : 0U);
      }
      if (run_->summary().cloud_points > 0) parts_ |= part::kCloud;
      if ((linkage_ = run_->linkage())) parts_ |= part::kMount | (run_->summary().tilts ? 0U : part::kLinkage);
      break;
    case RenderKind::kCloud:
      open_cloud();
      break;
    case RenderKind::kLinkage:
      set_linkage(input_);
      if (is_preset(input_)) name_ = input_;
      break;
    case RenderKind::kMap:
      parts_ = part::kMap;
      break;
    case RenderKind::kField:
      parts_ = part::kField;
      break;
    case RenderKind::kTrajectory:
      trajectory_file_ = input_;
      parts_ = part::kTrajectory;
      break;
  }
}

// Opens a file, or a folder with a cloud and perhaps the path.
void RenderSource::open_cloud() {
  cloud_file_ = given_cloud(input_);
  parts_ = part::kCloud;
  if (cloud_file_ == input_) return;
  name_ = name_of_place(input_);
  if (!has_file(input_, kTrajectoryName)) return;
  trajectory_file_ = in_folder(input_, kTrajectoryName);
  parts_ |= part::kTrajectory;
}

void RenderSource::set_linkage(const std::string& linkage) {
  linkage_ = resolve_linkage(linkage);
  parts_ |= part::kLinkage | part::kMount;
}

const OccupancyMap& RenderSource::map() {
  if (!map_) map_ = run_ ? run_->map() : read_occupancy_map(input_);
  return *map_;
}

const FieldPicture& RenderSource::field() {
  if (!field_) {
    DistanceFieldFile file = run_ ? run_->field() : read_distance_field(input_);
    field_ = FieldPicture{file.geometry, std::move(file.cells), file.cap};
  }
  return *field_;
}

// Double precision keeps the millimetres of a path in a national grid.
Trajectory RenderSource::read_trajectory() const {
  if (run_) return run_->trajectory();
  Trajectory trajectory = read_tum(trajectory_file_);
  if (cloud_file_.empty()) return trajectory;
  const std::array<double, 3> origin_m = origin_of_cloud(cloud_file_);
  for (StampedPose& pose : trajectory) {
    pose.T_map_base.x_m -= origin_m[0];
    pose.T_map_base.y_m -= origin_m[1];
  }
  return trajectory;
}

const Trajectory& RenderSource::trajectory() {
  if (!trajectory_) {
    trajectory_ = read_trajectory();
    if (trajectory_->empty()) throw InputError({run_ ? input_ : trajectory_file_, 0}, "has no poses");
  }
  return *trajectory_;
}

const calib::SweepModel& RenderSource::linkage() { return linkage_.value(); }

// Another thread checks a run's file against its report meanwhile.
PointsOfCloud RenderSource::cloud(const CloudReading& reading) const {
  SideThread check(run_.has_value(), 1);
  const auto finish = [&] {
    check.finish();
    if (run_) run_->files().expect_unchanged();
  };
  if (run_) check.give([this] { (void)run_->cloud_file(); });
  try {
    PointsOfCloud points = read_cloud(run_ ? run_->files().path(kCloudName) : cloud_file_, reading);
    finish();
    return points;
  } catch (const Error&) {  // report first if the file is not the run's own
    finish();
    throw;
  }
}

std::string RenderSource::cloud_file() const { return run_ ? run_->cloud_file().value() : cloud_file_; }

void RenderSource::require_values(CloudColour colour) const {
  if (kind_ != RenderKind::kCloud) return;  // a run has all values
  const CloudReader reader(cloud_file_);
  const CloudHeader& header = reader.header();
  const char* const missing = colour == CloudColour::kTime && !header.has_time             ? "times"
                              : colour == CloudColour::kElevation && !header.has_elevation ? "elevations"
                              : colour == CloudColour::kScan && !header.has_scan           ? "numbers of scans"
                                                                                           : nullptr;
  if (missing != nullptr) throw UsageError(fmt::format("--colour: {} has no {} of its points", cloud_file_, missing));
}

PathOverlay RenderSource::overlay() {
  if ((parts_ & part::kTrajectory) == 0) return {};
  PathOverlay overlay{trajectory(), {}, {}};
  if (run_) {
    overlay.keyframes = run_->summary().keyframes;
    overlay.doubtful = run_->summary().doubtful;
    overlay.drives = run_->summary().drives;
  }
  return overlay;
}

RenderSource::Graph RenderSource::graph() {
  const LoopFindings found = run_.value().doubts().loops.value();
  const std::vector<PoseCovariance> covariances = run_->covariances().value_or(std::vector<PoseCovariance>());
  const RunSummary& summary = run_->summary();
  return {graph_overlay(trajectory(), summary.keyframes, found.loops, covariances, found.uncertain, summary.drives),
          graph_subtitle(found.loops, found.uncertain, summary.scans)};
}

PointsOfCloud read_cloud(const std::string& path, const CloudReading& reading) {
  CloudReader reader(path);
  reader.make_relative();
  const std::uint64_t stated = reader.header().points;
  if (stated > kMostPoints) {
    throw InputError({path, 0}, fmt::format("has {} points, and at most {} can be drawn; thin it when it is mapped "
                                            "(--set cloud.voxel=\"5 cm\")",
                                            stated, kMostPoints));
  }
  std::error_code failed;
  const std::uintmax_t bytes = fs::file_size(path, failed);
  PointLimit limit(reading.most > 0 ? reading.most : kMostPoints);
  limit.expect(std::min<std::uint64_t>(stated, failed ? 0 : bytes / kFewestPointBytes));
  std::uint64_t read = 0;
  std::uint64_t near = 0;
  std::uint64_t wanted = 0;
  for (Cloud piece = reader.next(kPointsAtOnce); !piece.empty(); piece = reader.next(kPointsAtOnce)) {
    read += piece.size();
    reader.check_kept(read);
    std::erase_if(piece, [](const CloudPoint& point) { return !is_near(point); });
    near += piece.size();
    if (reading.is_wanted) std::erase_if(piece, [&](const CloudPoint& point) { return !reading.is_wanted(point); });
    wanted += piece.size();
    limit.add(piece);
    if (reading.progress) {
      reading.progress(read, stated > 0 ? static_cast<double>(read) / static_cast<double>(stated) : -1.0);
    }
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is written");
  }
  report_strays(path, reader, {read, near}, reading.remark);
  return {limit.take(), wanted};
}

std::array<double, 3> origin_of_cloud(const std::string& path) {
  CloudReader reader(path);
  reader.make_relative();
  (void)reader.next(1);
  return reader.origin_m();
}

std::string name_of_place(const std::string& path) {
  std::error_code failed;
  const fs::path whole = fs::weakly_canonical(path, failed);
  return failed || whole.filename().empty() ? "cloud" : whole.filename().string();
}

}  // namespace gdtslam
