// Makes the pictures of `gdtslam render`: a still or a film of a view, from the data of the sources. OpenGL is opened
// when the first view needs it. One studio belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/ticks.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"
#include "gdtslam/viewer/film.hpp"
#include "gdtslam/viewer/graphics.hpp"
#include "gdtslam/viewer/linkage_scene.hpp"
#include "options.hpp"
#include "source.hpp"
#include "views.hpp"

namespace gdtslam {

/// Length of a film.
struct FilmLength {
  std::size_t frames = 0;
  double frames_per_s = 25.0;
};

/// Default size of a still whose content has no shape of its own.
inline constexpr PictureSize kStillSize{1600, 1000};
/// Number of points in a still of a whole cloud: one per pixel, but at least a million.
std::uint64_t points_of_still(const PictureSize& size);

class RenderStudio {
 public:
  /// Both must outlive this.
  RenderStudio(const RenderOptions& options, std::vector<RenderSource>& sources);

  // Drawings of the views (RenderView). Each throws UsageError, InputError, or UnavailableError if nothing can draw. An
  // empty size selects one that suits the content.
  using Wanted = std::optional<PictureSize>;
  Canvas cloud(const Wanted& wanted);
  /// The first frame past the middle in which the beams' plane is half-way between the ends of a stroke, where it is
  /// seen edge-on.
  Canvas poster_of_scan(const Wanted& wanted);
  Canvas linkage(const Wanted& wanted);
  Canvas map(const Wanted& wanted);
  Canvas graph(const Wanted& wanted);
  Canvas before_and_after_loops(const Wanted& wanted);
  Canvas intensity(const Wanted& wanted);
  Canvas distance(const Wanted& wanted);
  Canvas errors_box(const Wanted& wanted);
  Canvas errors_cdf(const Wanted& wanted);
  Canvas errors_time(const Wanted& wanted);
  Canvas errors_path(const Wanted& wanted);
  /// A single path in the colours of time; several paths, or one with the truth, in one colour each.
  Canvas trajectory(const Wanted& wanted);
  /// Once around the cloud, or behind the robot along its path.
  std::unique_ptr<Film> cloud_film(const PictureSize& size, std::size_t frames);
  std::unique_ptr<Film> scan_film(const PictureSize& size, std::size_t frames);
  std::unique_ptr<Film> linkage_turn(const PictureSize& size, std::size_t frames);
  /// The last frame stays for a second.
  std::unique_ptr<Film> loops(const PictureSize& size, std::size_t frames);
  static constexpr double kOrbit_s = 8.0;
  static constexpr double kFollow_s = 20.0;
  static constexpr double kLongestScan_s = 20.0;

  /// By --seconds and --fps, else the view's default.
  [[nodiscard]] FilmLength film_length(const RenderView& view);

  /// Name of the renderer: "EGL, llvmpipe ..." or, without OpenGL, "Cairo".
  [[nodiscard]] std::string renderer() const;
  [[nodiscard]] std::uint64_t points_drawn() const { return points_drawn_; }
  /// Points of the cloud before thinning and before floor or ceiling were removed; in a scan, points of its time range.
  [[nodiscard]] std::uint64_t whole_points() const { return whole_points_; }
  /// The cloud of the first source, thinned to --points, else to `most` (0: no limit).
  Cloud read_cloud(std::uint64_t most);
  /// The distance of each point to --reference.
  std::vector<float> distances(const Cloud& cloud);
  /// "office-7f" or --title; "1,771,492 of 2,612,366 points, 62.8 m of path", or the scans if there are no points.
  [[nodiscard]] std::string title() const;
  [[nodiscard]] std::string subtitle(std::uint64_t points = 0) const;
  /// Length of the drawn trajectory, "62.8 m"; empty if there is none or the robot stands still.
  [[nodiscard]] std::string path_text() const;

 private:
  RenderSource& first() { return sources_.front(); }
  /// The path of the first source; empty if it has none.
  [[nodiscard]] Trajectory path() const;
  /// The time range of --time in the log's clock; by default its first 20 s.
  struct Stretch {
    double from_s = 0.0;
    double to_s = 0.0;
    double first_s = 0.0;  ///< start of the log, the zero of --time
  };
  Stretch stretch();
  Cloud read_stretch(std::uint64_t most, const std::optional<Stretch>& stretch);
  GraphicsContext& graphics();
  CloudScene& cloud_scene(CameraPreset from, std::uint64_t most, bool is_film);
  std::unique_ptr<Film> follow(const PictureSize& size, std::size_t frames, std::uint64_t most);
  std::unique_ptr<Film> scan(const PictureSize& size, std::size_t frames, std::uint64_t most);
  LinkageScene& linkage_scene(const PictureSize& size);
  [[nodiscard]] CloudLook cloud_look(CameraPreset from, bool is_film) const;
  [[nodiscard]] bool is_huge() const;
  [[nodiscard]] CloudCaption caption() const;
  /// "62.8 m of path, 48 % of the points drawn".
  [[nodiscard]] std::string scan_subtitle() const;
  void print_note(const std::string& remark) const;
  Canvas field(const Wanted& wanted, bool is_intensity);
  /// The errors of every source, grouped and over time.
  struct Errors {
    ErrorPlot plot;
    std::vector<TimeSeries> series;
  };
  Errors errors();
  [[nodiscard]] MapLook map_look() const;
  /// Names for legends: the sources' own names if they differ, else the names of files or folders, else the paths.
  [[nodiscard]] std::vector<std::string> distinct_names() const;
  [[nodiscard]] double frames_per_s() const;

  const RenderOptions& options_;
  std::vector<RenderSource>& sources_;
  Hidden hidden_;
  Viewpoint viewpoint_;
  std::unique_ptr<GraphicsContext> graphics_;
  Cloud drawn_;
  CloudLook look_;
  std::unique_ptr<CloudScene> cloud_scene_;
  std::unique_ptr<LinkageScene> linkage_scene_;
  std::uint64_t whole_points_ = 0;
  std::uint64_t points_drawn_ = 0;
};

/// The cloud's picture that `gdtslam map` writes: the iso view, 1600 by 900 pixels, as bytes of a PNG file. `linkage`
/// is null if the laser has none. Throws UnavailableError if nothing can draw, InputError, FileError.
std::string draw_run_cloud(const std::string& cloud_file, const std::string& log, const Trajectory& trajectory,
                           const calib::SweepModel* linkage);

/// "1,771,492 of 2,612,366 points", or only the number if all are drawn.
std::string points_text(std::uint64_t drawn, std::uint64_t whole);
/// The same with ", 62.8 m of path" for that length; an empty part is left out.
std::string cloud_subtitle(std::uint64_t drawn, std::uint64_t whole, const std::string& length);

}  // namespace gdtslam
