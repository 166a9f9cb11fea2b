// What is drawn over the film of a scanning robot: title, the moment in figures, the elevation running along, the mount
// seen close. Sizes follow one text size. One object belongs to one thread.
#pragma once

#include <memory>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"
#include "scanning_track.hpp"

namespace gdtslam {

/// One moment of the film.
struct ScanningMoment {
  double stamp_s = 0.0;
  double elevation_rad = 0.0;
  double crank_rad = 0.0;
  std::uint64_t points = 0;
};

class ScanningOverlay {
 public:
  /// Its times count from `zero_s`.
  ScanningOverlay(const ScanningTrack& track, double zero_s, const CloudLook& look, const CloudCaption& caption,
                  const PictureSize& size);

  /// Where the close view of the mount goes; nothing where the picture is too small for one.
  [[nodiscard]] const DrawingArea& inset() const { return inset_; }
  void draw(Canvas& canvas, const ScanningMoment& moment, const ColourScale& scale,
            const std::shared_ptr<const RgbaImage>& mount) const;

 private:
  void draw_title(Canvas& canvas) const;
  void draw_figures(Canvas& canvas, const ScanningMoment& moment, const ColourScale& scale) const;
  void draw_plot(Canvas& canvas, const ScanningMoment& moment) const;
  void draw_inset(Canvas& canvas, const ScanningMoment& moment, const std::shared_ptr<const RgbaImage>& mount) const;
  void draw_card(Canvas& canvas, const DrawingArea& area) const;

  const ScanningTrack& track_;
  double zero_s_;
  CloudLook look_;
  CloudCaption caption_;
  PictureSize size_;
  Theme theme_;
  double text_;
  DrawingArea plot_;
  DrawingArea inset_;
  double lowest_deg_ = 0.0;
  double highest_deg_ = 1.0;
};

}  // namespace gdtslam
