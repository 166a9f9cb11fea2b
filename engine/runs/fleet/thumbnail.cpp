#include "thumbnail.hpp"

#include "engine/io/atomic_file.hpp"
#include "engine/io/maps/png.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#ifdef GDTSLAM_HAS_RASTER
#include "gdtslam/drawing/raster.hpp"
#endif

namespace gdtslam {
namespace {

constexpr PictureSize kSize{.width = 320, .height = 180};  // below 200 pixels a picture has no words

#ifdef GDTSLAM_HAS_RASTER
constexpr const char* kThumbnail = "thumbnail.png";
std::string thumbnail_bytes(const Canvas& picture) {
  const RgbaImage image = raster_of(picture, 2.0);
  return encode_png(image.width, image.height, image.pixels);
}
#else
constexpr const char* kThumbnail = "thumbnail.svg";
std::string thumbnail_bytes(const Canvas& picture) {
  return svg_of(picture, [](const RgbaImage& image) { return encode_png(image.width, image.height, image.pixels); });
}
#endif

}  // namespace

void write_thumbnail(const std::string& folder, const MapOutcome& outcome) {
  if (outcome.occupancy.cells.size() == 0) return;
  std::string bytes;
  try {
    MapLook look;
    look.with_keyframes = false;
    bytes = thumbnail_bytes(map_picture(outcome.occupancy, {outcome.trajectory, {}, {}, {}}, look, kSize));
  } catch (const Error&) {  // the page does without
    return;
  }
  write_file_atomically(folder + "/" + kThumbnail, bytes);
}

const char* thumbnail_name() { return kThumbnail; }

}  // namespace gdtslam
