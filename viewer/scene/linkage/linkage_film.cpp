#include "gdtslam/core/error.hpp"
#include "gdtslam/viewer/linkage_scene.hpp"
#include "linkage_cycle.hpp"

namespace gdtslam {
namespace {

class LinkageFilm : public Film {
 public:
  LinkageFilm(LinkageScene& scene, const calib::SweepModel& model, const PictureSize& size, std::size_t frames)
      : scene_(scene), cycle_(model), size_(size), frames_(frames) {
    if (frames == 0) throw UsageError("a film has at least one frame");
  }
  [[nodiscard]] std::size_t frames() const override { return frames_; }
  Canvas frame(std::size_t k) override {
    return scene_.picture(cycle_.crank_at(static_cast<double>(k) / static_cast<double>(frames_)), size_);
  }

 private:
  LinkageScene& scene_;
  LinkageCycle cycle_;
  PictureSize size_;
  std::size_t frames_;
};

}  // namespace

std::unique_ptr<Film> linkage_film(LinkageScene& scene, const calib::SweepModel& model, const PictureSize& size,
                                   std::size_t frames) {
  return std::make_unique<LinkageFilm>(scene, model, size, frames);
}

}  // namespace gdtslam
