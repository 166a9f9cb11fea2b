#include "studio.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/runs/folder/run_pictures.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "viewer/scene/cloud/cloud_values.hpp"

namespace gdtslam {
namespace {

constexpr double kFramesPerSecond = 25.0;
constexpr double kMostFrames = 100'000.0;
constexpr double kFarDistance_m = 1.0;     // limit of distances to a reference, if the scale shows no more
constexpr std::size_t kStillFrames = 101;  // frames of the film that a still is taken from
constexpr std::uint64_t kFilmPoints = 500'000;
constexpr std::uint64_t kFollowPoints = 1'000'000;  // seen from close by

// A cloud from the side is long and low: it fills the picture between title and bars.
PictureSize size_of_elevation(double width_m, double height_m) {
  constexpr double kShareOfWidth = 0.88;  // share that a parallel camera leaves to the cloud
  constexpr double kWords_px = 150.0;     // above and below
  constexpr double kLowest_px = 260.0;
  const double rows = kShareOfWidth * kStillSize.width * height_m / std::max(width_m, 1e-3) + kWords_px;
  return {kStillSize.width, static_cast<std::uint32_t>(std::clamp(rows, kLowest_px, 1.0 * kStillSize.width))};
}

// Parallel views of long and low clouds waste no rows.
PictureSize size_for(CameraPreset from, const Bounds& bounds) {
  if (bounds.is_empty()) return kStillSize;
  const Point3 extent = bounds.highest - bounds.lowest;
  if (from == CameraPreset::kFront) return size_of_elevation(extent.x(), extent.z());
  if (from == CameraPreset::kSide) return size_of_elevation(extent.y(), extent.z());
  if (from != CameraPreset::kTop) return kStillSize;
  return size_for_content(std::max(extent.x(), extent.y()), std::min(extent.x(), extent.y()));
}

}  // namespace

std::string points_text(std::uint64_t drawn, std::uint64_t whole) {
  return drawn < whole ? with_commas(drawn) + " of " + counted(whole, "point") : counted(drawn, "point");
}

std::string cloud_subtitle(std::uint64_t drawn, std::uint64_t whole, const std::string& length) {
  std::string text = drawn > 0 ? points_text(drawn, whole) : std::string();
  if (!length.empty()) text += (text.empty() ? "" : ", ") + length + " of path";
  return text;
}

std::uint64_t points_of_still(const PictureSize& size) {
  constexpr std::uint64_t kFewestPoints = 1'000'000;  // about 200 MB
  return std::max(kFewestPoints, std::uint64_t{size.width} * size.height);
}

RenderStudio::RenderStudio(const RenderOptions& options, std::vector<RenderSource>& sources)
    : options_(options),
      sources_(sources),
      hidden_(read_hidden(options.hide)),
      viewpoint_(read_viewpoint(options.from)) {}

GraphicsContext& RenderStudio::graphics() {
  if (!graphics_) graphics_ = std::make_unique<GraphicsContext>();
  return *graphics_;
}

std::string RenderStudio::renderer() const { return graphics_ ? graphics_->description() : "Cairo"; }

void RenderStudio::print_note(const std::string& remark) const {
  if (!options_.quiet) print_remark(remark);
}

std::string RenderStudio::title() const { return options_.title.empty() ? sources_.front().name() : options_.title; }

std::string RenderStudio::subtitle(std::uint64_t points) const {
  const RunReader* const run = sources_.front().run();
  if (run != nullptr && points == 0) {
    const RunSummary& summary = run->summary();
    return run_subtitle({summary.scans, summary.keyframes.size(), summary.doubtful.size()}, path(), summary.drives);
  }
  return cloud_subtitle(points, whole_points_, path_text());
}

Trajectory RenderStudio::path() const {
  RenderSource& source = sources_.front();
  return (source.parts() & part::kTrajectory) == 0 ? Trajectory() : source.trajectory();
}

std::string RenderStudio::path_text() const {
  const RunReader* const run = sources_.front().run();
  return run != nullptr ? path_length_text(path(), run->summary().drives) : path_length_text(path());
}

Cloud RenderStudio::read_stretch(std::uint64_t most, const std::optional<Stretch>& stretch) {
  ProgressLine progress("points", options_.quiet);
  CloudReading reading{.most = options_.points > 0 ? options_.points : most,
                       .progress = [&progress](std::uint64_t done, double share) { progress.update(done, share); },
                       .remark = [this](const std::string& remark) { print_note(remark); }};
  if (stretch) {
    reading.is_wanted = [&stretch](const CloudPoint& point) {
      return point.stamp_s >= stretch->from_s && point.stamp_s <= stretch->to_s;
    };
  }
  PointsOfCloud points = first().cloud(reading);
  whole_points_ = points.points;
  return std::move(points.cloud);
}

Cloud RenderStudio::read_cloud(std::uint64_t most) { return read_stretch(most, std::nullopt); }

std::vector<float> RenderStudio::distances(const Cloud& cloud) {
  if (options_.reference.empty()) {
    throw UsageError("--colour distance needs what the distances are to: --reference CLOUD, in the same frame");
  }
  ProgressLine progress("points", options_.quiet);
  std::optional<RunReader> run;
  const std::string file = given_cloud(options_.reference, run);
  Cloud reference =
      gdtslam::read_cloud(file,
                          {.progress = [&progress](std::uint64_t done, double share) { progress.update(done, share); },
                           .remark = [this](const std::string& remark) { print_note(remark); }})
          .cloud;
  // Both clouds were read relative to their own origins.
  const std::array<double, 3> to = origin_of_cloud(sources_.front().cloud_file());
  const std::array<double, 3> from = origin_of_cloud(file);
  if (run) run->files().expect_unchanged();
  for (CloudPoint& point : reference) {
    point.x_m += static_cast<float>(from[0] - to[0]);
    point.y_m += static_cast<float>(from[1] - to[1]);
    point.z_m += static_cast<float>(from[2] - to[2]);
  }
  const CloudLook look = read_cloud_look(options_);
  const double shown_m = look.colour == CloudColour::kDistance ? look.most.value_or(0.0) : 0.0;
  return distances_to(cloud, reference, std::max(kFarDistance_m, shown_m));
}

// A ceiling hides the rooms from above; from the side it belongs to the picture.
CloudLook RenderStudio::cloud_look(CameraPreset from, bool is_film) const {
  CloudLook look = read_cloud_look(options_);
  const bool is_from_side = from == CameraPreset::kFront || from == CameraPreset::kSide;
  look.with_ceiling = hidden_.nothing || (is_from_side && !hidden_.ceiling);
  look.with_floor = !hidden_.floor;
  if (is_film || is_huge()) look.samples = 1;
  return look;
}

// OpenGL draws at most 16384 pixels a side, so the largest pictures have one sample per pixel.
bool RenderStudio::is_huge() const {
  constexpr std::uint32_t kMostSmooth_px = 8192;
  if (options_.size.empty()) return false;
  const PictureSize size = read_size(options_.size);
  return size.width > kMostSmooth_px || size.height > kMostSmooth_px;
}

CloudCaption RenderStudio::caption() const {
  if (hidden_.caption) return {"", "", false};
  return {title(), subtitle(points_drawn_), true};
}

std::string RenderStudio::scan_subtitle() const {
  std::string text = path_text();
  if (!text.empty()) text += " of path";
  if (points_drawn_ == whole_points_) return text;
  const double share = 100.0 * static_cast<double>(points_drawn_) / static_cast<double>(whole_points_);
  return fmt::format("{}{}{:.0f} % of the points drawn", text, text.empty() ? "" : ", ", share);
}

CloudScene& RenderStudio::cloud_scene(CameraPreset from, std::uint64_t most, bool is_film) {
  look_ = cloud_look(from, is_film);
  first().require_values(look_.colour);
  drawn_ = read_cloud(most);
  const bool by_distance = look_.colour == CloudColour::kDistance;
  const std::vector<float> distances_m = by_distance ? distances(drawn_) : std::vector<float>();
  cloud_scene_ = std::make_unique<CloudScene>(graphics(), look_);
  cloud_scene_->set_cloud(drawn_, distances_m);
  points_drawn_ = cloud_scene_->points_drawn();
  if ((first().parts() & part::kTrajectory) != 0 && !hidden_.path) {
    cloud_scene_->set_trajectory(first().trajectory());
    const bool has_linkage = (first().parts() & part::kLinkage) != 0;
    cloud_scene_->set_robot(first().trajectory().back().T_map_base, has_linkage ? &first().linkage() : nullptr);
  }
  return *cloud_scene_;
}

Canvas RenderStudio::cloud(const Wanted& wanted) {
  const CameraPreset from = viewpoint_.preset;
  if (from == CameraPreset::kFollow) {
    return follow(wanted.value_or(kStillSize), kStillFrames, 0)->frame(kStillFrames / 2);
  }
  const bool shows_all = !viewpoint_.camera;
  CloudScene& scene = cloud_scene(from, shows_all ? points_of_still(wanted.value_or(kStillSize)) : 0, false);
  drawn_ = {};  // the scene keeps the points that it draws
  const PictureSize size = wanted ? *wanted : size_for(from, scene.bounds());
  const Camera camera = viewpoint_.camera ? *viewpoint_.camera : fitting_camera(from, scene.bounds(), size);
  const auto image = std::make_shared<const RgbaImage>(scene.render(camera, size));
  return cloud_picture(image, scene.scale(), camera, look_, caption());
}

LinkageScene& RenderStudio::linkage_scene(const PictureSize& size) {
  constexpr std::uint32_t kNarrowest = 640;  // a panel beside the scene needs room
  const LinkageLook look{.is_dark = read_background(options_.background) == Background::kDark,
                         .is_transparent = read_background(options_.background) == Background::kNone,
                         .with_panel = !hidden_.caption && size.width >= kNarrowest,
                         .samples = is_huge() ? 1U : 2U};
  linkage_scene_ = std::make_unique<LinkageScene>(graphics(), first().linkage(), look);
  return *linkage_scene_;
}

Canvas RenderStudio::linkage(const Wanted& wanted) {
  const PictureSize size = wanted.value_or(kStillSize);
  LinkageScene& scene = linkage_scene(size);
  return scene.picture(scene.shown_crank_rad(), size);
}

std::unique_ptr<Film> RenderStudio::linkage_turn(const PictureSize& size, std::size_t frames) {
  return linkage_film(linkage_scene(size), first().linkage(), size, frames);
}

std::unique_ptr<Film> RenderStudio::cloud_film(const PictureSize& size, std::size_t frames) {
  if (viewpoint_.preset == CameraPreset::kFollow) return follow(size, frames, kFollowPoints);
  if (viewpoint_.camera || viewpoint_.preset != CameraPreset::kIso) {
    throw UsageError("--from " + options_.from +
                     ": a film goes once around (--from iso) or along the path (--from robot)");
  }
  CloudScene& scene = cloud_scene(CameraPreset::kIso, kFilmPoints, true);
  return orbit_film(scene, look_, caption(), size, frames);
}

std::unique_ptr<Film> RenderStudio::follow(const PictureSize& size, std::size_t frames, std::uint64_t most) {
  if ((first().parts() & part::kTrajectory) == 0) {
    throw UsageError("--from robot: " + first().input() + " has no trajectory to follow");
  }
  CloudScene& scene = cloud_scene(CameraPreset::kFollow, most, most > 0);
  try {
    return follow_film(scene, first().trajectory(), look_, caption(), size, frames);
  } catch (const InputError& error) {
    throw InputError({first().input(), 0}, error.what());
  }
}

std::unique_ptr<Film> RenderStudio::scan_film(const PictureSize& size, std::size_t frames) {
  return scan(size, frames, kFilmPoints);
}

Canvas RenderStudio::poster_of_scan(const Wanted& wanted) {
  const std::unique_ptr<Film> film = scan(wanted.value_or(kStillSize), kStillFrames, 0);
  const Stretch time = stretch();
  const double middle_s = 0.5 * (time.from_s + time.to_s);
  const auto by_elevation = [](const CloudPoint& a, const CloudPoint& b) { return a.elevation_rad < b.elevation_rad; };
  const auto [lowest, highest] = std::minmax_element(drawn_.begin(), drawn_.end(), by_elevation);
  const float half_rad = 0.5F * (lowest->elevation_rad + highest->elevation_rad);
  const float near_rad = 0.05F * (highest->elevation_rad - lowest->elevation_rad);
  double shown_s = time.to_s;
  for (const CloudPoint& point : drawn_) {
    const bool is_half_way = std::fabs(point.elevation_rad - half_rad) <= near_rad;
    if (is_half_way && point.stamp_s >= middle_s) shown_s = std::min(shown_s, point.stamp_s);
  }
  const double share = (shown_s - time.from_s) / (time.to_s - time.from_s);
  return film->frame(static_cast<std::size_t>(share * static_cast<double>(kStillFrames - 1)));
}

// Only points of the time range are read and thinned, so the number drawn is met.
std::unique_ptr<Film> RenderStudio::scan(const PictureSize& size, std::size_t frames, std::uint64_t most) {
  look_ = cloud_look(CameraPreset::kFollow, most > 0);
  first().require_values(look_.colour);
  const Stretch time = stretch();
  drawn_ = read_stretch(most, time);
  if (drawn_.empty()) throw InputError({first().input(), 0}, "has no points of that time");
  points_drawn_ = drawn_points(drawn_, sampled_level_surfaces(drawn_), look_).size();
  const ScanningFilmInput input{.cloud = &drawn_,
                                .trajectory = &first().trajectory(),
                                .model = &first().linkage(),
                                .has_linkage = (first().parts() & part::kLinkage) != 0,
                                .from_s = time.from_s,
                                .to_s = time.to_s,
                                .zero_s = time.first_s};
  // The picture counts its points as they appear, so the total is not printed.
  CloudCaption words = caption();
  if (!hidden_.caption) words.subtitle = scan_subtitle();
  return scanning_film(graphics(), input, look_, words, size, frames);
}

double RenderStudio::frames_per_s() const {
  return options_.frames_per_s > 0.0 ? options_.frames_per_s : kFramesPerSecond;
}

FilmLength RenderStudio::film_length(const RenderView& view) {
  FilmLength length{0, frames_per_s()};
  double seconds = view.film_s;
  if (viewpoint_.preset == CameraPreset::kFollow) seconds = kFollow_s;
  if ((view.effects & effect::kTime) != 0) {
    const Stretch time = stretch();
    seconds = std::min(time.to_s - time.from_s, view.film_s);
  }
  if (!options_.seconds.empty()) seconds = quantity_of("--seconds", options_.seconds, Unit::kSecond);
  if (!(seconds > 0.0)) throw UsageError("--seconds: " + options_.seconds + " is not above 0");
  const double frames = std::max(1.0, std::floor(seconds * length.frames_per_s + 0.5));
  if (!(frames <= kMostFrames)) throw UsageError(fmt::format("a film has at most {:.0f} frames", kMostFrames));
  length.frames = static_cast<std::size_t>(frames);
  return length;
}

RenderStudio::Stretch RenderStudio::stretch() {
  double first_s = std::numeric_limits<double>::infinity();
  double last_s = -first_s;
  for (const StampedPose& pose : first().trajectory()) {
    first_s = std::min(first_s, pose.stamp_s);
    last_s = std::max(last_s, pose.stamp_s);
  }
  const OpenRange time = read_time_range(options_.time);
  const double from_s = first_s + time.least.value_or(0.0);
  const double to_s = std::min(time.most ? first_s + *time.most : from_s + kLongestScan_s, last_s);
  if (from_s < first_s || from_s >= to_s) {
    throw UsageError(fmt::format("--time {}: leaves nothing of a log of {:.1f} s; it counts from the first pose",
                                 options_.time, last_s - first_s));
  }
  return {from_s, to_s, first_s};
}

std::string draw_run_cloud(const std::string& cloud_file, const std::string& log, const Trajectory& trajectory,
                           const calib::SweepModel* linkage) {
  constexpr PictureSize kSize{1600, 900};
  const GraphicsContext graphics;
  CloudLook look;
  look.with_ceiling = false;
  CloudScene scene(graphics, look);
  std::uint64_t points = 0;
  {
    const PointsOfCloud still = read_cloud(cloud_file, {.most = points_of_still(kSize)});
    points = still.points;
    scene.set_cloud(still.cloud);
  }
  scene.set_trajectory(trajectory);
  scene.set_robot(trajectory.back().T_map_base, linkage);
  const Camera camera = fitting_camera(CameraPreset::kIso, scene.bounds(), kSize);
  const CloudCaption caption{.title = run_title({log}),
                             .subtitle = cloud_subtitle(scene.points_drawn(), points, path_length_text(trajectory))};
  const auto image = std::make_shared<const RgbaImage>(scene.render(camera, kSize));
  return png_bytes(rasterise(cloud_picture(image, scene.scale(), camera, look, caption)));
}

}  // namespace gdtslam
