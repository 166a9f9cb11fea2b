#include "loops_timeline.hpp"

#include <algorithm>

namespace gdtslam {
namespace {

constexpr std::size_t kLeastBend = 4;  // frames in which the eye can follow
constexpr std::size_t kMostBend = 25;
constexpr std::size_t kFadeShare = 12;  // of the film in which the map comes up

std::size_t fading(const LoopsFilmLength& length) { return length.frames / kFadeShare; }

/// Frames of the drive and of what bends it.
std::size_t moving(const LoopsFilmLength& length) {
  const std::size_t still = length.held + fading(length);
  return length.frames > still ? length.frames - still : 0;
}

double eased(double share) { return share * share * (3.0 - 2.0 * share); }

class TimelineMaker {
 public:
  explicit TimelineMaker(std::vector<LoopsInstant>& frames) : frames_(frames) {}
  void drive_to(double at_m) {
    now_.driven_m = at_m;
    frames_.push_back(now_);
  }
  void bend(std::size_t stage, std::size_t count) {
    now_.stage = stage;
    for (std::size_t k = 1; k <= count; ++k) {
      now_.bent = eased(static_cast<double>(k) / static_cast<double>(count));
      frames_.push_back(now_);
    }
    now_.bent = 1.0;
  }
  void arrive() { now_.is_over = true; }
  void come_to(double at_m) { now_.driven_m = at_m; }
  void bring_up_map(std::size_t count) {
    for (std::size_t k = 1; k <= count; ++k) {
      now_.map_share = static_cast<double>(k) / static_cast<double>(count + 1);
      frames_.push_back(now_);
    }
    now_.map_share = 1.0;
  }
  void hold(std::size_t count) { frames_.insert(frames_.end(), count, now_); }

 private:
  std::vector<LoopsInstant>& frames_;
  LoopsInstant now_;
};

}  // namespace

std::size_t most_loop_stages(const LoopsFilmLength& length) {
  return std::max<std::size_t>(2, moving(length) / (2 * kLeastBend)) - 1;
}

std::vector<LoopsInstant> loops_timeline(const std::vector<double>& stages_m, double path_m,
                                         const LoopsFilmLength& length) {
  const std::size_t bends = stages_m.size() + 1;
  const std::size_t bend = std::clamp<std::size_t>(moving(length) / (2 * bends), 1, kMostBend);
  const std::size_t drive = std::max(moving(length), bend * bends + 1) - bend * bends;
  std::vector<LoopsInstant> frames;
  TimelineMaker maker(frames);
  std::size_t stage = 0;
  for (std::size_t k = 1; k <= drive; ++k) {
    const double at_m = path_m * static_cast<double>(k) / static_cast<double>(drive);
    for (; stage < stages_m.size() && (stages_m[stage] <= at_m || k == drive); ++stage) {
      maker.come_to(stages_m[stage]);
      maker.bend(stage + 1, bend);
    }
    maker.drive_to(at_m);
  }
  maker.arrive();
  maker.bend(bends, bend);
  maker.bring_up_map(fading(length));
  maker.hold(length.held);
  // Of a film too short for all of it the end is what counts.
  const std::size_t count = std::max<std::size_t>(length.frames, 1);
  if (frames.size() > count) frames.erase(frames.begin(), frames.end() - static_cast<std::ptrdiff_t>(count));
  return frames;
}

}  // namespace gdtslam
