#include "render_source.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "did_you_mean.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/io/distance_field_file.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "interrupt.hpp"
#include "linkage_beside.hpp"
#include "linkage_file.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostPoints = 200'000'000;
constexpr std::size_t kPointsAtOnce = 1U << 16U;

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

// The beginning of a file, unpacked.
std::string head_of(const std::string& path) {
  constexpr std::size_t kHeadBytes = 65536;
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(::gzopen(path.c_str(), "rb"), ::gzclose);
  if (!file) throw FileError(path, "cannot be opened: " + std::generic_category().message(errno));
  std::string head(kHeadBytes, '\0');
  const int count = ::gzread(file.get(), head.data(), static_cast<unsigned>(head.size()));
  head.resize(count > 0 ? static_cast<std::size_t>(count) : 0);  // what is damaged shows when it is read in full
  return head;
}

// True where a line of the text begins with the word.
bool has_line(std::string_view text, std::string_view word) {
  for (std::size_t begin = 0; begin < text.size();) {
    if (text.substr(begin).starts_with(word)) return true;
    const std::size_t end = text.find('\n', begin);
    if (end == std::string_view::npos) return false;
    begin = end + 1;
  }
  return false;
}

// Eight numbers on the first line that is no comment: stamp, place and rotation.
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
  const std::string head = head_of(path);
  if (head.starts_with("ply\n") || head.starts_with("ply\r") || head.starts_with("# .PCD") ||
      head.starts_with("VERSION")) {
    return RenderKind::kCloud;
  }
  if (has_line(head, "gdtslam_linkage:")) return RenderKind::kLinkage;
  if (has_line(head, "image:")) return has_line(head, "occupied_thresh:") ? RenderKind::kMap : RenderKind::kField;
  const bool is_picture = head.starts_with("\x89PNG") || head.starts_with("P5") || head.starts_with("P2");
  if (is_picture) {
    throw InputError({path, 0}, "is a picture; give the .yaml beside it, or the folder of the run");
  }
  if (has_line(head, "gdtslam_scene:")) {
    throw InputError({path, 0}, "is a scene; 'gdtslam simulate' makes a log of it, which can be rendered");
  }
  return is_tum(head) ? RenderKind::kTrajectory : RenderKind::kLog;
}

// "cloud" from "out/cloud.ply.gz".
std::string stem_of(const std::string& path) {
  fs::path name = fs::path(path).filename();
  if (name.extension() == ".gz") name = name.stem();
  return name.stem().string();
}

}  // namespace

std::string_view name_of(RenderKind kind) {
  constexpr std::array<std::string_view, 7> kNames{"a run",        "a cloud", "a linkage", "a map", "a distance field",
                                                   "a trajectory", "a log"};
  return kNames[static_cast<std::size_t>(kind)];
}

RenderKind kind_of_input(const std::string& input) {
  if (input == "-") return RenderKind::kLog;
  std::error_code failed;
  const fs::file_status status = fs::status(input, failed);
  if (fs::is_directory(status)) {
    if (RunReader::is_run(input)) return RenderKind::kRun;
    throw InputError({input, 0},
                     "is a folder without report.json, so no run of 'gdtslam map'; give a run, a cloud, a linkage, a "
                     "map's .yaml, a trajectory or a log");
  }
  if (fs::exists(status)) return fs::is_regular_file(status) ? kind_of_file(input) : RenderKind::kLog;
  if (is_preset(input)) return RenderKind::kLinkage;
  throw FileError(input, "there is no such file, folder or linkage preset" + did_you_mean(input, preset_names()));
}

RenderSource::RenderSource(std::string input)
    : input_(std::move(input)), name_(stem_of(input_)), kind_(kind_of_input(input_)) {
  switch (kind_) {
    case RenderKind::kRun:
      run_.emplace(input_);
      name_ = run_->name();
      parts_ = part::kMap | part::kField | part::kTrajectory | (run_->cloud_file() ? part::kCloud : 0U);
      if ((linkage_ = run_->linkage())) parts_ |= part::kLinkage;
      break;
    case RenderKind::kCloud:
      parts_ = part::kCloud;
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
      parts_ = part::kTrajectory;
      break;
    case RenderKind::kLog:
      throw Error(ExitCode::kFailed, input_ + ": a log has to be mapped before it is drawn");
  }
}

void RenderSource::set_linkage(const std::string& linkage) {
  linkage_ = resolve_linkage(linkage);
  parts_ |= part::kLinkage;
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

const Trajectory& RenderSource::trajectory() {
  if (!trajectory_) {
    trajectory_ = run_ ? run_->trajectory() : read_tum(input_);
    if (trajectory_->empty()) throw InputError({input_, 0}, "has no poses");
  }
  return *trajectory_;
}

const calib::SweepModel& RenderSource::linkage() { return linkage_.value(); }

Cloud RenderSource::cloud(const std::function<void(std::uint64_t, double)>& progress) const {
  return read_whole_cloud(run_ ? run_->cloud_file().value() : input_, progress);
}

PathOverlay RenderSource::overlay() {
  if ((parts_ & part::kTrajectory) == 0) return {};
  PathOverlay overlay{trajectory(), {}, {}};
  if (run_) {
    overlay.keyframes = run_->summary().keyframes;
    overlay.doubtful = run_->summary().doubtful;
  }
  return overlay;
}

Cloud read_whole_cloud(const std::string& path, const std::function<void(std::uint64_t, double)>& progress) {
  CloudReader reader(path);
  const std::uint64_t told = reader.header().points;
  if (told > kMostPoints) {
    throw InputError({path, 0}, fmt::format("has {} points, and at most {} can be drawn; thin it when it is mapped "
                                            "(--set cloud.voxel=\"5 cm\")",
                                            told, kMostPoints));
  }
  Cloud cloud;
  for (Cloud piece = reader.next(kPointsAtOnce); !piece.empty(); piece = reader.next(kPointsAtOnce)) {
    cloud.insert(cloud.end(), piece.begin(), piece.end());
    if (progress)
      progress(cloud.size(), told > 0 ? static_cast<double>(cloud.size()) / static_cast<double>(told) : -1.0);
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is written");
  }
  if (cloud.empty()) throw InputError({path, 0}, "has no points to draw");
  return cloud;
}

}  // namespace gdtslam
