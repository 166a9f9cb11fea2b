#include "views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>

#include "engine/io/atomic_file.hpp"
#include "files/film_writer.hpp"
#include "files/glb.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/viewer/page.hpp"
#include "studio.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "viewer/scene/cloud/cloud_values.hpp"
#include "viewer/scene/linkage/linkage_model.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr PictureSize kFilmSize{1280, 720};
constexpr PictureSize kGifSize{640, 360};
constexpr std::uint64_t kPagePoints = 500'000;
constexpr std::uint64_t kMostGlbPoints = 1'000'000;
constexpr double kTurn_s = 4.0;  // one turn of a linkage in glTF, the same as in its film

// Names of the possible views, "map, graph"; for a film without a moving view, those of stills.
std::string views_instead(unsigned parts, bool moves) {
  std::string there_are = views_there_are(parts, moves);
  if (!there_are.empty()) return there_are;
  const std::string of_stills = views_there_are(parts, false);
  return of_stills.empty() ? "none" : of_stills + ", and none of them moves";
}

// The requested view or the default, checked against input and output.
const RenderView& choose_view(const RenderOptions& options, const std::vector<RenderSource>& sources, OutputKind kind) {
  const RenderSource& source = sources.front();
  const unsigned parts = render_parts(options, sources);
  const bool moves = is_film(kind);
  const std::string there_are = views_there_are(parts, moves);
  if (options.view.empty()) {
    if (!options.as.empty()) throw UsageError("--as: says which kind of a --view is drawn, and no view is named");
    if (const RenderView* const view = default_view(parts, moves)) return *view;
    throw UsageError(fmt::format("{}: {} has no view {}{}", source.input(), to_string(source.kind()),
                                 moves ? "that moves, as " + std::string(to_string(kind)) + " needs" : "without more",
                                 moves ? "; .png .svg and .pdf fit its views " + views_there_are(parts, false)
                                       : ": give --reference or --relations"));
  }
  const RenderView& view = render_view(options.view, options.as);
  if (const std::string missing = missing_parts(view, parts, " and no "); !missing.empty()) {
    throw UsageError(fmt::format("--view {}: {} has no {}; its views are {}", view.words(), source.input(), missing,
                                 views_instead(parts, moves)));
  }
  if (moves && !view.moves()) {
    throw UsageError(fmt::format("--view {} does not move, so it is not for {}; .png .svg and .pdf fit{}", view.name,
                                 to_string(kind),
                                 there_are.empty() ? "" : ", and the views that move are " + there_are));
  }
  return view;
}

std::uint64_t size_of_file(const std::string& path) {
  std::error_code failed;
  const std::uintmax_t size = fs::file_size(path, failed);
  return failed ? 0 : static_cast<std::uint64_t>(size);
}

std::string default_file(const RenderSource& source, const RenderView& view) {
  return fmt::format("{}-{}{}{}.png", source.name(), view.name, view.as.empty() ? "" : "-", view.as);
}

// Removes floor and ceiling if the options say so, as in pictures.
Cloud filtered(Cloud cloud, const Hidden& hidden) {
  if (!hidden.floor && !hidden.ceiling) return cloud;
  CloudLook look;
  look.with_floor = !hidden.floor;
  look.with_ceiling = !hidden.ceiling;
  Cloud kept;
  for (const std::uint32_t k : drawn_points(cloud, sampled_level_surfaces(cloud), look)) kept.push_back(cloud[k]);
  return kept;
}

// Centres the drawing on a page of this size, with the drawing's own background.
Canvas on_page(const Canvas& drawing, double width, double height) {
  constexpr double kSame = 1e-6;
  if (std::fabs(width - drawing.width()) < kSame && std::fabs(height - drawing.height()) < kSame) return drawing;
  Canvas page(width, height, drawing.title());
  if (!drawing.shapes().empty()) {
    const auto* const ground = std::get_if<shape::Rectangle>(&drawing.shapes().front());
    if (ground != nullptr && ground->width >= drawing.width() && ground->height >= drawing.height()) {
      page.rectangle(Point2::Zero(), width, height, ground->fill);
    }
  }
  page.place(drawing, {0.5 * (width - drawing.width()), 0.5 * (height - drawing.height())});
  return page;
}

class Render {
 public:
  Render(const RenderOptions& options, std::vector<RenderSource>& sources)
      : options_(options), sources_(sources), studio_(options_, sources) {}

  RenderResult run() {
    result_.kind = options_.output.empty() ? OutputKind::kPng : read_output_kind(options_.output);
    result_.file = options_.output;
    if (const RunReader* const run = sources_.front().run();
        run != nullptr && !run->has_trajectory() && !options_.quiet) {
      print_remark(run->folder() + ": has no trajectory.tum, so that no path is drawn");
    }
    if (has_no_view(result_.kind)) {
      require_one_input(nullptr);
      refuse_view();
      refuse_idle_options(options_, nullptr, result_.kind, is_linkage_model());
      result_.kind == OutputKind::kPage ? write_page() : write_model();
    } else {
      const RenderView& view = choose_view(options_, sources_, result_.kind);
      require_one_input(&view);
      refuse_idle_options(options_, &view, result_.kind);
      result_.view = view.name;
      result_.as = view.as;
      if (result_.file.empty()) {
        result_.file = default_file(sources_.front(), view);
        require_writable(options_, result_.file);
      }
      is_film(result_.kind) ? write_film(view) : write_still(view);
    }
    result_.renderer = studio_.renderer();
    result_.points_of = std::max(result_.points, studio_.whole_points());
    if (result_.bytes == 0) result_.bytes = size_of_file(result_.file);
    return result_;
  }

 private:
  void require_one_input(const RenderView* view) const {
    if (sources_.size() == 1 || (view != nullptr && view->compares())) return;
    throw UsageError(fmt::format(
        "{} draws one input, and {} are given; several are compared by the views trajectory and errors, "
        "which needs --reference or --relations FILE",
        view == nullptr ? std::string(to_string(result_.kind)) : "--view " + view->words(), sources_.size()));
  }

  void refuse_view() const {
    if (options_.view.empty() && options_.as.empty() && options_.size.empty()) return;
    throw UsageError(fmt::format("--view, --as and --size are for pictures, not for {}", to_string(result_.kind)));
  }

  /// Whether the output is a .glb of an input with a linkage but no cloud.
  [[nodiscard]] bool is_linkage_model() const {
    const unsigned parts = sources_.front().parts() & (part::kCloud | part::kLinkage);
    return result_.kind == OutputKind::kGlb && parts == part::kLinkage;
  }

  [[nodiscard]] PictureSize film_size() const {
    if (!options_.size.empty()) return read_size(options_.size);
    return result_.kind == OutputKind::kGif ? kGifSize : kFilmSize;
  }

  void write_still(const RenderView& view) {
    std::optional<PictureSize> wanted;
    if (!options_.size.empty()) wanted = read_size(options_.size);
    Canvas drawing = (studio_.*view.draw)(wanted);
    // Plots are drawn small and scaled up to the requested pixels.
    const bool is_pixels = result_.kind == OutputKind::kPng;
    const PictureSize target = wanted.value_or(kStillSize);
    const double fit = std::min(target.width / drawing.width(), target.height / drawing.height());
    const double scale = (view.effects & effect::kPlot) != 0 && is_pixels ? fit : 1.0;
    if (wanted && is_pixels) drawing = on_page(drawing, target.width / scale, target.height / scale);
    write_file_atomically(result_.file, drawing_bytes(drawing, result_.file, scale));
    result_.width = static_cast<std::uint32_t>(std::lround(drawing.width() * scale));
    result_.height = static_cast<std::uint32_t>(std::lround(drawing.height() * scale));
    result_.points = studio_.points_drawn();
  }
  void write_film(const RenderView& view) {
    if (read_background(options_.background) == Background::kNone && result_.kind != OutputKind::kFrames) {
      throw UsageError(fmt::format("--background none: not for {}; .png and frames can be", to_string(result_.kind)));
    }
    const PictureSize wanted = film_size();
    const FilmLength length = studio_.film_length(view);
    const FilmKind film_kind = result_.kind == OutputKind::kFrames ? FilmKind::kFrames
                               : result_.kind == OutputKind::kGif  ? FilmKind::kGif
                                                                   : FilmKind::kMp4;
    const std::unique_ptr<FilmWriter> writer =
        open_film({film_kind, result_.file, wanted.width, wanted.height, length.frames_per_s});
    const std::unique_ptr<Film> film = (studio_.*view.film)(wanted, length.frames);
    ProgressLine progress("frames", options_.quiet);
    for (std::size_t k = 0; k < film->frames(); ++k) {
      if (interrupted()) {
        throw Error(
            ExitCode::kInterrupted,
            fmt::format("interrupted after {} of {} frames; {}", k, film->frames(),
                        result_.kind == OutputKind::kFrames ? "they are in " + result_.file : "nothing is written"));
      }
      writer->add(rasterise(film->frame(k)));
      if (result_.kind == OutputKind::kFrames) result_.bytes += size_of_file(frame_path(result_.file, k));
      progress.update(k + 1, static_cast<double>(k + 1) / static_cast<double>(film->frames()));
    }
    writer->finish();
    result_.width = wanted.width;
    result_.height = wanted.height;
    result_.frames = film->frames();
    result_.film_s = static_cast<double>(film->frames()) / length.frames_per_s;
    result_.points = studio_.points_drawn();
  }
  void write_page() {
    RenderSource& source = sources_.front();
    PageInput page;
    page.title = studio_.title();
    Cloud cloud;
    std::vector<float> distances_m;
    if ((source.parts() & part::kCloud) != 0) {
      cloud = studio_.read_cloud(kPagePoints);
      page.cloud = &cloud;
      if (!options_.reference.empty()) {
        distances_m = studio_.distances(cloud);
        page.distances_m = &distances_m;
      }
    }
    if ((source.parts() & part::kTrajectory) != 0) page.trajectory = &source.trajectory();
    if (source.run() != nullptr) page.drives = source.run()->summary().drives;
    if ((source.parts() & part::kMap) != 0) page.map = &source.map();
    if ((source.parts() & part::kLinkage) != 0) page.linkage = &source.linkage();
    page.subtitle = studio_.subtitle(cloud.size());
    add_facts(page);
    write_file_atomically(result_.file, make_page(page));
    result_.points = cloud.size();
  }
  void write_model() {
    RenderSource& source = sources_.front();
    if (is_linkage_model()) {
      constexpr int kSteps = 120;  // steps of 3 degrees; a straight line deviates by 0.04 % of the crank
      write_linkage_glb(result_.file, studio_.title(), linkage_solids(source.linkage(), kSteps), kTurn_s);
      return;
    }
    if ((source.parts() & part::kCloud) == 0) {
      throw UsageError(fmt::format("{}: has no 3D cloud{}, so {} cannot be made of it", source.input(),
                                   result_.kind == OutputKind::kGlb ? " and no linkage" : "", to_string(result_.kind)));
    }
    const CloudLook look = read_cloud_look(options_);
    source.require_values(look.colour);
    const Hidden hidden = read_hidden(options_.hide);
    const Cloud cloud = filtered(studio_.read_cloud(result_.kind == OutputKind::kGlb ? kMostGlbPoints : 0), hidden);
    result_.points = cloud.size();
    if (result_.kind == OutputKind::kCloud) {
      CloudWriter writer(result_.file, find_cloud_format(result_.file));
      writer.add(cloud);
      writer.finish();
      return;
    }
    const bool has_path = (source.parts() & part::kTrajectory) != 0 && !hidden.path;
    const std::vector<Colour> colours = point_colours(
        cloud, look, look.colour == CloudColour::kDistance ? studio_.distances(cloud) : std::vector<float>());
    const CloudModel model{.name = studio_.title(),
                           .cloud = cloud,
                           .colours = colours,
                           .trajectory = has_path ? &source.trajectory() : nullptr};
    write_cloud_glb(result_.file, model);
  }
  void add_facts(PageInput& page) const {
    const RunReader* const run = sources_.front().run();
    if (page.cloud != nullptr) {
      const std::uint64_t count = page.cloud->size();
      const std::uint64_t whole = studio_.whole_points();
      page.facts.emplace_back("Points", with_commas(count) + (count < whole ? " of " + with_commas(whole) : ""));
    }
    if (const std::string path = studio_.path_text(); !path.empty()) page.facts.emplace_back("Path", path);
    if (run == nullptr) return;
    const RunSummary& summary = run->summary();
    page.facts.emplace_back("Scans", with_commas(summary.scans));
    page.facts.emplace_back("Matched", with_commas(summary.matched));
    page.facts.emplace_back("Doubtful", with_commas(summary.doubtful.size()));
    page.facts.emplace_back("Keyframes", with_commas(summary.keyframe_count));
  }

  RenderOptions options_;
  std::vector<RenderSource>& sources_;
  RenderStudio studio_;
  RenderResult result_;
};

}  // namespace

unsigned render_parts(const RenderOptions& options, const std::vector<RenderSource>& sources) {
  return sources.front().parts() | (has_truth(options) ? part::kTruth : 0U) |
         (has_true_path(options) ? part::kTruePath : 0U);
}

RenderResult render(const RenderOptions& options, std::vector<RenderSource>& sources) {
  return Render(options, sources).run();
}

}  // namespace gdtslam
