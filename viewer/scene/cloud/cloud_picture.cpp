// The words and bars over the picture of a cloud, in the order of need: the first to come finds room.
#include <utility>

#include "cloud_layout.hpp"

namespace gdtslam {
namespace {

PictureSize size_of(const RgbaImage& scene) { return {.width = scene.width, .height = scene.height}; }

}  // namespace

std::optional<BarPlace> bar_place_of(const RgbaImage& scene, const ColourScale& scale, const Camera& camera,
                                     const CloudLook& look, const CloudCaption& caption) {
  Canvas canvas(scene.width, scene.height, "");
  CloudLayout layout(canvas, look);
  layout.write_title(caption);
  if (caption.with_scale_bar) layout.draw_scale_bar(camera, size_of(scene));
  return layout.best_bar_place(scale, scene);
}

Canvas cloud_picture_at(std::optional<BarPlace> place, std::shared_ptr<const RgbaImage> scene, const ColourScale& scale,
                        const Camera& camera, const CloudLook& look, const CloudCaption& caption) {
  const RgbaImage& image = *scene;  // the canvas keeps it
  const PictureSize size = size_of(image);
  Canvas canvas(size.width, size.height, caption.title.empty() ? "Point cloud" : caption.title);
  canvas.picture({0.0, 0.0}, size.width, size.height, std::move(scene));
  CloudLayout layout(canvas, look);
  layout.write_title(caption);
  if (caption.with_scale_bar) layout.draw_scale_bar(camera, size);
  if (caption.with_colour_bar) {
    const std::optional<BarPlace> at = place ? place : layout.best_bar_place(scale, image);
    if (at) layout.draw_colour_bar(scale, *at);
  }
  if (caption.with_axes) layout.draw_axes(camera);
  return canvas;
}

Canvas cloud_picture(std::shared_ptr<const RgbaImage> scene, const ColourScale& scale, const Camera& camera,
                     const CloudLook& look, const CloudCaption& caption) {
  return cloud_picture_at(std::nullopt, std::move(scene), scale, camera, look, caption);
}

}  // namespace gdtslam
