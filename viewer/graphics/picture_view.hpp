// A picture on its way: what is seen of the scene, and the bands of rows in which it is drawn, one after the other, so
// that no buffer is as large as the picture with all its samples. Pixels here are samples; rows count from the bottom.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gdtslam/viewer/camera.hpp"
#include "shading.hpp"

namespace gdtslam {

/// Rows that are drawn together. What is kept of them has neighbours on both sides for the shading.
struct PictureBand {
  std::uint32_t first_row = 0;
  std::uint32_t rows = 0;  ///< of all bands of a picture the same
  std::uint32_t first_kept = 0;
  std::uint32_t kept = 0;
};

struct PictureView {
  Camera camera;     ///< depths count from its eye; that of a parallel camera stands before everything
  DepthRange range;  ///< of the depth buffer
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<PictureBand> bands;
};

/// How a picture is cut.
struct BandShape {
  std::uint32_t samples = 1;              ///< each band keeps whole pixels of so many rows
  std::uint32_t margin = 0;               ///< rows more on both sides, within the picture
  std::uint32_t most_pixels = 1U << 20U;  ///< of a band, about
};
std::vector<PictureBand> bands_of(std::uint32_t width, std::uint32_t height, const BandShape& shape);

/// What is drawn into the picture beside VTK's props.
class PictureLayer {
 public:
  PictureLayer() = default;
  PictureLayer(const PictureLayer&) = delete;
  PictureLayer& operator=(const PictureLayer&) = delete;
  virtual ~PictureLayer() = default;
  /// Of what there is to be seen.
  [[nodiscard]] virtual const Bounds& bounds() const = 0;
  /// Before the first band.
  virtual void begin(const PictureView& view) = 0;
  /// Over what VTK has drawn: whatever is nearer than the depth in the picture takes its place.
  virtual void draw(std::size_t band, RawPicture& picture) = 0;
};

}  // namespace gdtslam
