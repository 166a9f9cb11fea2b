#include "loops_film.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine/drawing/maps/map_pictures.hpp"
#include "engine/drawing/maps/map_sheet.hpp"
#include "engine/mapping/graph/graph_replay.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kGlowFrames = 20;

Pose2 pose_between(const Pose2& from, const Pose2& to, double share) {
  return {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m),
          from.theta_rad + share * wrap_angle(to.theta_rad - from.theta_rad)};
}

/// Rotates a covariance of the tangent at this pose to the axes of the map.
PoseCovariance along_map(const Matrix3& covariance, const Pose2& pose) {
  const Matrix3 turn = adjoint_matrix({0.0, 0.0, pose.theta_rad});
  const Matrix3 c = turn * times_transposed(covariance, turn);
  return {.xx = c(0, 0), .xy = c(0, 1), .xt = c(0, 2), .yy = c(1, 1), .yt = c(1, 2), .tt = c(2, 2)};
}

PoseCovariance covariance_between(const PoseCovariance& a, const PoseCovariance& b, double share) {
  const auto mix = [share](double from, double to) { return from + share * (to - from); };
  return {.xx = mix(a.xx, b.xx),
          .xy = mix(a.xy, b.xy),
          .xt = mix(a.xt, b.xt),
          .yy = mix(a.yy, b.yy),
          .yt = mix(a.yt, b.yt),
          .tt = mix(a.tt, b.tt)};
}

/// A run with its stages, drawn at any instant.
class LoopsReplay {
 public:
  LoopsReplay(RenderSource& source, std::size_t most_stages)
      : run_(read_run_graph(*source.run())),
        path_(source.trajectory(), run_.scans, source.map()),
        stages_(replay_graph(run_.graph, most_stages)),
        start_s_(source.trajectory().front().stamp_s) {
    ReplayStage adjusted;
    adjusted.place = path_.final_places().size() - 1;
    adjusted.poses = path_.final_places();
    adjusted.covariances = {stages_.back().covariances.back()};
    stages_.push_back(std::move(adjusted));
    make_scene(source);
  }

  [[nodiscard]] const LoopsPath& path() const { return path_; }
  [[nodiscard]] const LoopsScene& scene() const { return scene_; }
  /// The stages; the last one is the adjusted path.
  [[nodiscard]] const std::vector<ReplayStage>& stages() const { return stages_; }
  /// `glow`: brightness of the loops of each stage.
  [[nodiscard]] LoopsMoment moment(const LoopsInstant& instant, const std::vector<double>& glow) const {
    const std::vector<Pose2> places = places_at(instant);
    LoopsMoment moment;
    moment.path_m = path_.bent(places, instant.driven_m);
    if (instant.map_share < 1.0) moment.walls_m = path_.walls(places, instant.driven_m);
    moment.map_share = instant.map_share;
    for (std::size_t stage = 0; stage <= instant.stage; ++stage) {
      for (const std::size_t index : stages_[stage].loops) {
        const Loop& loop = run_.graph.loops[index];
        moment.loops.push_back({.from_m = places[loop.relation.from].translation(),
                                .to_m = places[loop.relation.to].translation(),
                                .weight = loop.weight,
                                .is_on = run_.is_on[index],
                                .glow = glow[stage]});
      }
    }

    // Loops that are switched off are few and are drawn on top.
    std::stable_sort(moment.loops.begin(), moment.loops.end(),
                     [](const MovedLoop& a, const MovedLoop& b) { return a.is_on && !b.is_on; });
    if (instant.is_over) return moment;
    moment.robot_m = moment.path_m.back();
    moment.robot_covariance = covariance_in(stages_[instant.stage], instant.driven_m);
    if (instant.stage > 0 && instant.bent < 1.0) {
      moment.robot_covariance = covariance_between(covariance_in(stages_[instant.stage - 1], instant.driven_m),
                                                   moment.robot_covariance, instant.bent);
    }
    return moment;
  }
  /// "12 min 5 s, 340 m, 3 of 4 loops on"; before the first loop without the loops.
  [[nodiscard]] std::string read_out(const LoopsInstant& instant) const {
    std::size_t found = 0;
    std::size_t on = 0;
    for (std::size_t stage = 0; stage <= instant.stage; ++stage) {
      for (const std::size_t index : stages_[stage].loops) {
        ++found;
        on += run_.is_on[index] ? 1U : 0U;
      }
    }
    const std::string loops = found > 0 || instant.is_over ? ", " + loops_text(found, on) : "";
    return fmt::format("{}, {:.0f} m{}", picture::duration_text(path_.stamp_at(instant.driven_m) - start_s_),
                       instant.driven_m, loops);
  }

 private:
  void make_scene(RenderSource& source) {
    scene_.map = &source.map();
    for (std::size_t k = 0; k < stages_.size(); ++k) {
      const ReplayStage& stage = stages_[k];
      const std::size_t end = k + 1 < stages_.size() ? stages_[k + 1].place : stage.place;
      for (std::size_t i = 0; i <= end; ++i) scene_.extent.push_back({0.0, stage.poses[i]});
      for (std::size_t i = 0; i < stage.covariances.size(); ++i) {
        const double sigma_m = along_map(stage.covariances[i], stage.poses[stage.place + i]).sigma_m();
        if (std::isfinite(sigma_m)) scene_.largest_sigma_m = std::max(scene_.largest_sigma_m, sigma_m);
      }
    }
    for (const StampedPose& pose : source.trajectory()) scene_.extent.push_back(pose);
    for (const bool is_on : run_.is_on) (is_on ? scene_.has_loops_on : scene_.has_loops_off) = true;
  }
  [[nodiscard]] std::vector<Pose2> places_at(const LoopsInstant& instant) const {
    const std::vector<Pose2>& to = stages_[instant.stage].poses;
    if (instant.bent >= 1.0 || instant.stage == 0) return to;
    const std::vector<Pose2>& from = stages_[instant.stage - 1].poses;
    std::vector<Pose2> places;
    places.reserve(to.size());
    for (std::size_t i = 0; i < to.size(); ++i) places.push_back(pose_between(from[i], to[i], instant.bent));
    return places;
  }
  /// Covariance of the robot's pose at this distance in a stage.
  [[nodiscard]] PoseCovariance covariance_in(const ReplayStage& stage, double driven_m) const {
    const std::size_t last = stage.place + stage.covariances.size() - 1;
    const std::size_t place = std::clamp(path_.place_at(driven_m), stage.place, last);
    const std::size_t next = std::min(place + 1, last);
    const double way_m = path_.place_m(next) - path_.place_m(place);
    const double share = way_m > 0.0 ? std::clamp((driven_m - path_.place_m(place)) / way_m, 0.0, 1.0) : 0.0;
    return covariance_between(along_map(stage.covariances[place - stage.place], stage.poses[place]),
                              along_map(stage.covariances[next - stage.place], stage.poses[next]), share);
  }

  RunGraph run_;
  LoopsPath path_;
  std::vector<ReplayStage> stages_;
  double start_s_;
  LoopsScene scene_;
};

class LoopsFilm : public Film {
 public:
  LoopsFilm(RenderSource& source, MapLook look, const PictureSize& size, const LoopsFilmLength& length)
      : replay_(source, most_loop_stages(length)), look_(std::move(look)), size_(size) {
    const std::vector<ReplayStage>& stages = replay_.stages();
    std::vector<double> stages_m;
    for (std::size_t k = 1; k + 1 < stages.size(); ++k) stages_m.push_back(replay_.path().place_m(stages[k].place));
    timeline_ = loops_timeline(stages_m, replay_.path().length_m(), length);
    begins_.assign(stages.size(), timeline_.size());
    for (std::size_t k = timeline_.size(); k-- > 0;) begins_[timeline_[k].stage] = k;
  }

  [[nodiscard]] std::size_t frames() const override { return timeline_.size(); }
  Canvas frame(std::size_t k) override {
    std::vector<double> glow(begins_.size(), 0.0);
    for (std::size_t stage = 0; stage < begins_.size(); ++stage) {
      if (k < begins_[stage] || k - begins_[stage] >= kGlowFrames) continue;
      const double share = static_cast<double>(k - begins_[stage]) / static_cast<double>(kGlowFrames);
      glow[stage] = (1.0 - share) * (1.0 - timeline_[k].map_share);
    }
    MapLook look = look_;
    if (!look.title.empty()) look.subtitle = replay_.read_out(timeline_[k]);
    return loops_picture(replay_.scene(), replay_.moment(timeline_[k], glow), look, size_);
  }

 private:
  LoopsReplay replay_;
  MapLook look_;
  PictureSize size_;
  std::vector<LoopsInstant> timeline_;
  std::vector<std::size_t> begins_;  ///< first frame of each stage
};

}  // namespace

std::unique_ptr<Film> loops_film(RenderSource& source, const MapLook& look, const PictureSize& size,
                                 const LoopsFilmLength& length) {
  return std::make_unique<LoopsFilm>(source, look, size, length);
}

Canvas loops_before_and_after(RenderSource& source, const MapLook& look, const std::optional<PictureSize>& wanted) {
  const LoopsReplay replay(source, 1);
  const picture::MapArea area = picture::shown_area(source.map(), replay.scene().extent);
  const double aspect = wanted ? wanted->aspect() : 1.0;
  const bool is_wide = area.width_m() > aspect * area.height_m();  // one above the other leaves both larger
  const PictureSize size = wanted.value_or(size_for_content(is_wide ? area.width_m() : 2.0 * area.width_m(),
                                                            is_wide ? 2.0 * area.height_m() : area.height_m()));
  const PictureSize part{std::max(is_wide ? size.width : size.width / 2, 1U),
                         std::max(is_wide ? size.height / 2 : size.height, 1U)};
  const Point2 second(size.width - part.width, size.height - part.height);
  const std::vector<double> no_glow(replay.stages().size(), 0.0);
  LoopsScene scene = replay.scene();
  scene.largest_sigma_m = 0.0;
  Canvas both(size.width, size.height, look.title.empty() ? "Loops" : look.title);
  for (const std::size_t stage : {std::size_t{0}, replay.stages().size() - 1}) {
    const LoopsInstant instant{.driven_m = replay.path().length_m(), .stage = stage, .is_over = stage > 0};
    LoopsMoment moment = replay.moment(instant, no_glow);
    moment.robot_m.reset();
    MapLook words = look;
    if (!look.title.empty()) {
      words.title = stage == 0 ? look.title + ", as it was driven" : "With loops";
      words.subtitle = replay.read_out(instant);
    }
    both.place(loops_picture(scene, moment, words, part), stage == 0 ? Point2(0.0, 0.0) : second);
  }
  return both;
}

}  // namespace gdtslam
