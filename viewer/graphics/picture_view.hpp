// A picture during drawing: the visible part of the scene, the bands of rows, and the host's work on each band
// (eye-dome lighting, averaging of samples). Bands are drawn one after the other, so no buffer is as large as the
// picture with all its samples. Pixels here are samples; rows count from the bottom, as OpenGL reads them; colours are
// premultiplied by alpha. Pure functions; time linear in the pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gdtslam/drawing/image.hpp"
#include "gdtslam/viewer/camera.hpp"

namespace gdtslam {

/// A picture as read from OpenGL.
struct RawPicture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 per pixel
  std::vector<float> depth;        ///< 0 near to 1 far, 1 if nothing was drawn; empty unless requested
};

/// Conversion of depth buffer values to distances.
struct DepthRange {
  double nearest_m = 1.0;
  double farthest_m = 2.0;
  bool is_parallel = false;
  /// Distance at which a perspective camera would show as much as the parallel one does; scales its steps of depth.
  double equivalent_m = 1.0;
};

/// Darkens every pixel that lies behind its neighbours [Boucheny2009]. Three rings of neighbours (`radius` pixels away,
/// twice and four times as far) give edges a soft shadow on the surface behind. Tilted planes keep their colours,
/// because 1/depth is linear over the picture of a plane; so do surfaces in front of the empty background. Consumes the
/// depth.
void shade_eye_dome(RawPicture& picture, const DepthRange& range, std::uint32_t radius);
/// Distance of the farthest neighbours that shading with this radius reads, pixels.
std::uint32_t shading_reach(std::uint32_t radius);

/// Sets the alpha of a picture over black from the same picture over white. Their difference is the share of the
/// background.
void set_alpha_from(RawPicture& over_black, const RawPicture& over_white);

/// Rows of a picture to average, and their place in the image. Both count from the bottom.
struct AveragedRows {
  std::uint32_t first = 0;      ///< in the picture
  std::uint32_t image_row = 0;  ///< in the image
  std::uint32_t count = 0;      ///< rows of the image
};
/// Writes the means of samples x samples pixels each to rows of an image. If `is_premultiplied`, divides the colours by
/// alpha.
void average_rows(const RawPicture& picture, const AveragedRows& rows, std::uint32_t samples, bool is_premultiplied,
                  RgbaImage& image);

/// Rows that are drawn together. The kept rows have neighbours on both sides for the shading.
struct PictureBand {
  std::uint32_t first_row = 0;
  std::uint32_t rows = 0;  ///< the same number in all bands of a picture
  std::uint32_t first_kept = 0;
  std::uint32_t kept = 0;
};

struct PictureView {
  Camera camera;     ///< depths count from its eye; the eye of a parallel camera is in front of everything
  DepthRange range;  ///< range of the depth buffer
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<PictureBand> bands;
};

/// Division of a picture into bands.
struct BandShape {
  std::uint32_t samples = 1;              ///< rows of samples per pixel; each band keeps whole pixels
  std::uint32_t margin = 0;               ///< extra rows on both sides, within the picture
  std::uint32_t most_pixels = 1U << 20U;  ///< approximate upper limit of a band's size
};
std::vector<PictureBand> cut_into_bands(std::uint32_t width, std::uint32_t height, const BandShape& shape);

/// A part of the picture that is drawn in addition to VTK's props.
class PictureLayer {
 public:
  PictureLayer() = default;
  PictureLayer(const PictureLayer&) = delete;
  PictureLayer& operator=(const PictureLayer&) = delete;
  virtual ~PictureLayer() = default;
  /// Bounds of everything that can be seen.
  [[nodiscard]] virtual const Bounds& bounds() const = 0;
  /// Called once, before the first band.
  virtual void begin(const PictureView& view) = 0;
  /// Draws over VTK's picture: a pixel is replaced if this layer is nearer than the depth in the picture.
  virtual void draw(std::size_t band, RawPicture& picture) = 0;
};

}  // namespace gdtslam
