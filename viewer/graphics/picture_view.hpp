// A picture on its way: what is seen of the scene, the bands of rows in which it is drawn, one after the other, so that
// no buffer is as large as the picture with all its samples, and the work of the host on each: eye-dome lighting and
// the averaging of samples. Pixels here are samples; rows count from the bottom, as OpenGL reads them; colours are
// premultiplied by alpha. Pure functions; time linear in the pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gdtslam/drawing/image.hpp"
#include "gdtslam/viewer/camera.hpp"

namespace gdtslam {

/// A picture as OpenGL gives it.
struct RawPicture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 per pixel
  std::vector<float> depth;        ///< 0 near to 1 far, 1 where nothing was drawn; empty unless asked for
};

/// How the numbers of a depth buffer become distances.
struct DepthRange {
  double nearest_m = 1.0;
  double farthest_m = 2.0;
  bool is_parallel = false;
  /// Distance at which a perspective camera would show as much as the parallel one does; scales its steps of depth.
  double equivalent_m = 1.0;
};

/// Darkens every pixel that lies behind its neighbours [Boucheny2009], over three rings of neighbours: `radius` pixels
/// away, twice and four times as far, so that an edge casts a soft shadow on what is behind it. Planes keep their
/// colours however they are tilted, because 1/depth is linear over a plane's picture; so does what stands before
/// nothing. Consumes the depth.
void shade_eye_dome(RawPicture& picture, const DepthRange& range, std::uint32_t radius);
/// How far from a pixel its neighbours lie that such a radius looks at.
std::uint32_t shading_reach(std::uint32_t radius);

/// Sets the alpha of a picture over black from the same picture over white: what is behind shows by their difference.
void set_alpha_from(RawPicture& over_black, const RawPicture& over_white);

/// Rows of a picture that are averaged, and where they go; all from the bottom.
struct AveragedRows {
  std::uint32_t first = 0;      ///< in the picture
  std::uint32_t image_row = 0;  ///< in the image
  std::uint32_t count = 0;      ///< rows of the image
};
/// The means of samples x samples pixels each into rows of an image, colours no longer premultiplied where
/// `is_premultiplied`.
void average_rows(const RawPicture& picture, const AveragedRows& rows, std::uint32_t samples, bool is_premultiplied,
                  RgbaImage& image);

/// Rows that are drawn together. What is kept of them has neighbours on both sides for the shading.
struct PictureBand {
  std::uint32_t first_row = 0;
  std::uint32_t rows = 0;  ///< the same number in all bands of a picture
  std::uint32_t first_kept = 0;
  std::uint32_t kept = 0;
};

struct PictureView {
  Camera camera;     ///< depths count from its eye; that of a parallel camera stands before everything
  DepthRange range;  ///< range of the depth buffer
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<PictureBand> bands;
};

/// How a picture is cut.
struct BandShape {
  std::uint32_t samples = 1;              ///< each band keeps whole pixels of so many rows
  std::uint32_t margin = 0;               ///< rows more on both sides, within the picture
  std::uint32_t most_pixels = 1U << 20U;  ///< about the largest size of a band
};
std::vector<PictureBand> cut_into_bands(std::uint32_t width, std::uint32_t height, const BandShape& shape);

/// A part of the picture beside VTK's props.
class PictureLayer {
 public:
  PictureLayer() = default;
  PictureLayer(const PictureLayer&) = delete;
  PictureLayer& operator=(const PictureLayer&) = delete;
  virtual ~PictureLayer() = default;
  /// Bounds of everything that can be seen.
  [[nodiscard]] virtual const Bounds& bounds() const = 0;
  /// Before the first band.
  virtual void begin(const PictureView& view) = 0;
  /// Over what VTK has drawn: whatever is nearer than the depth in the picture takes its place.
  virtual void draw(std::size_t band, RawPicture& picture) = 0;
};

}  // namespace gdtslam
