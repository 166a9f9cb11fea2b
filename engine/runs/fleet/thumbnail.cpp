#include "thumbnail.hpp"

#include "engine/io/atomic_file.hpp"
#include "engine/io/maps/png.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/raster.hpp"

namespace gdtslam {

void write_thumbnail(const std::string& folder, const MapOutcome& outcome) {
  constexpr PictureSize kSize{.width = 320, .height = 180};  // below 200 pixels a picture has no words
  if (outcome.occupancy.cells.size() == 0) return;
  std::string bytes;
  try {
    MapLook look;
    look.with_keyframes = false;
    const RgbaImage image =
        raster_of(map_picture(outcome.occupancy, {outcome.trajectory, {}, {}, {}}, look, kSize), 2.0);
    bytes = encode_png(image.width, image.height, image.pixels);
  } catch (const Error&) {  // the page does without
    return;
  }
  write_file_atomically(folder + "/" + kThumbnailName, bytes);
}

}  // namespace gdtslam
