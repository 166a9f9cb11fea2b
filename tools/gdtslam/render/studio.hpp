// Makes the pictures of `gdtslam render`: a still or a film of a view, from what the sources hold. OpenGL is looked for
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

/// How long a film is.
struct FilmLength {
  std::size_t frames = 0;
  double frames_per_s = 25.0;
};

/// Size of a still without --size whose content has no shape of its own.
inline constexpr PictureSize kStillSize{1600, 1000};
/// Points of a still that shows a cloud as a whole: as many as it has pixels, or a million.
std::uint64_t points_of_still(const PictureSize& size);

class RenderStudio {
 public:
  /// Both must outlive this.
  RenderStudio(const RenderOptions& options, std::vector<RenderSource>& sources);

  // Drawings of the views (RenderView). Each throws UsageError, InputError, or UnavailableError if nothing can draw.
  // Without a size one that suits the content.
  using Wanted = std::optional<PictureSize>;
  Canvas cloud(const Wanted& wanted);
  /// At the end of a stroke the plane of the beams is seen edge-on; the first frame past the middle that has it
  /// half-way.
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
  /// One path alone in the colours of time; over the truth or several, each in a colour of its own.
  Canvas trajectory(const Wanted& wanted);
  /// Once around the cloud, or behind the robot along its path.
  std::unique_ptr<Film> cloud_film(const PictureSize& size, std::size_t frames);
  std::unique_ptr<Film> scan_film(const PictureSize& size, std::size_t frames);
  std::unique_ptr<Film> linkage_turn(const PictureSize& size, std::size_t frames);
  /// Held for a second at its end.
  std::unique_ptr<Film> loops(const PictureSize& size, std::size_t frames);
  static constexpr double kOrbit_s = 8.0;
  static constexpr double kFollow_s = 20.0;
  static constexpr double kLongestScan_s = 20.0;

  /// By --seconds and --fps, else what suits the view.
  [[nodiscard]] FilmLength film_length(const RenderView& view);

  /// Name of the renderer: "EGL, llvmpipe ..." or, without OpenGL, "Cairo".
  [[nodiscard]] std::string renderer() const;
  [[nodiscard]] std::uint64_t points_drawn() const { return points_drawn_; }
  /// Points of the cloud before it was thinned and lost floor or ceiling; in a scan, those of its stretch of time.
  [[nodiscard]] std::uint64_t whole_points() const { return whole_points_; }
  /// The cloud of the first source, thinned to --points or else `most` (0: all).
  Cloud read_cloud(std::uint64_t most);
  /// The distance of each point to --reference.
  std::vector<float> distances(const Cloud& cloud);
  /// "office-7f" or --title; "1,771,492 of 2,612,366 points, 62.8 m of path", or of what has none, its scans.
  [[nodiscard]] std::string title() const;
  [[nodiscard]] std::string subtitle(std::uint64_t points = 0) const;
  /// "62.8 m" of the trajectory that is drawn; empty without one or if the robot stands.
  [[nodiscard]] std::string path_text() const;

 private:
  RenderSource& first() { return sources_.front(); }
  /// The path of the first source; empty if it has none.
  [[nodiscard]] Trajectory path() const;
  /// The stretch of --time in the log's clock; by default the first 20 s of it.
  struct Stretch {
    double from_s = 0.0;
    double to_s = 0.0;
    double first_s = 0.0;  ///< begin of the log, from which --time counts
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
  /// The errors of every source, as groups and over time.
  struct Errors {
    ErrorPlot plot;
    std::vector<TimeSeries> series;
  };
  Errors errors();
  [[nodiscard]] MapLook map_look() const;
  /// For legends: each source's own name if those differ; else the names of their files or folders, else the paths.
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

/// The picture of its cloud that `gdtslam map` leaves beside it: the iso view, 1600 by 900 pixels, as the bytes of a
/// PNG file. `linkage` may be null: the laser has none. Throws UnavailableError if nothing can draw, InputError,
/// FileError.
std::string draw_run_cloud(const std::string& cloud_file, const std::string& log, const Trajectory& trajectory,
                           const calib::SweepModel* linkage);

/// "1,771,492 of 2,612,366 points", or the points if those are all.
std::string points_text(std::uint64_t drawn, std::uint64_t whole);
/// The same with ", 62.8 m of path" for that length; a part that there is none of is left out.
std::string cloud_subtitle(std::uint64_t drawn, std::uint64_t whole, const std::string& length);

}  // namespace gdtslam
