// Pictures of a linkage: name and class, read-outs, elevation and transmission angle over the crank with a mark at one
// position, the bars' lengths, and the linkage as a schematic. Films show a 3D scene instead of the schematic. All
// sizes follow one text size: a small picture has fewer parts, never illegible ones. One object belongs to one thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calib/linkage/linkage_cycle.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/plot.hpp"

namespace gdtslam {

/// Positions of all parts in a picture; an area without width is left out.
struct LinkageSheet {
  double text = 13.0;  ///< letter size of plain words
  DrawingArea header = {};
  DrawingArea card = {};   ///< under the linkage and the bars' lengths
  DrawingArea scene = {};  ///< the linkage itself
  DrawingArea bars = {};   ///< lengths of the bars, below the linkage
  DrawingArea figures = {};
  DrawingArea elevation = {};
  DrawingArea transmission = {};
};
/// The sheet of a picture of this size in pixels; without a panel, or without room for one, only the scene.
LinkageSheet linkage_sheet(double width, double height, bool with_panel);

/// One decimal, without a unit and never "-0.0".
std::string degrees_text(double angle_rad);

class LinkagePanel {
 public:
  /// `cycle` must outlive this. Transparent: no page behind the cards.
  LinkagePanel(const calib::LinkageCycle& cycle, bool is_dark, bool is_transparent);

  /// Draws page and cards, then header and bars; the scene is drawn next, on its card.
  void draw_ground(Canvas& canvas, const LinkageSheet& sheet) const;
  /// Draws angles and curves with this position marked.
  void draw_readings(Canvas& canvas, const LinkageSheet& sheet, const calib::LinkagePosition& position) const;
  /// Labels an end of the laser's sweep with its elevation, beyond the rim; `inner` is a point towards the middle; page
  /// coordinates.
  void draw_sweep_label(Canvas& canvas, const LinkageSheet& sheet, const Point2& rim, const Point2& inner,
                        double elevation_rad) const;
  [[nodiscard]] const Theme& theme() const { return theme_; }

 private:
  void draw_header(Canvas& canvas, const LinkageSheet& sheet) const;
  void draw_bars(Canvas& canvas, const LinkageSheet& sheet) const;
  void draw_figures(Canvas& canvas, const LinkageSheet& sheet, const calib::LinkagePosition& position) const;
  void draw_elevation(Canvas& canvas, const LinkageSheet& sheet, const calib::LinkagePosition& position) const;
  void draw_transmission(Canvas& canvas, const LinkageSheet& sheet, const calib::LinkagePosition& position) const;
  /// A plot over the crank, on a card.
  [[nodiscard]] Plot plot_on(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& card,
                             std::string_view heading, double from, double to) const;
  void shade_strokes(Plot& plot) const;
  /// Legend of the shades, at the right of a heading, if there is room.
  void draw_strokes_key(Canvas& canvas, const LinkageSheet& sheet, double from_x) const;
  /// Position of a crank angle on the plots' axis, degrees.
  [[nodiscard]] double axis_deg(double crank_rad) const;

  const calib::LinkageCycle& cycle_;
  bool is_transparent_;
  Theme theme_;
  Colour laser_;                           ///< the elevation's curve
  Colour laser_text_;                      ///< words on the laser
  std::vector<Point2> elevations_deg_;     ///< over the axis
  std::vector<Point2> transmissions_deg_;  ///< over the axis, too
};

/// The linkage as a drawing (1280 by 800): positions over the lift, the curve of the coupler's middle, the rocker's
/// arc, dead points and the laser's plane, with the panel beside them. Orientation as in the mount: the laser's plane
/// is drawn along the rocker, so elevation 0 is level.
Canvas linkage_drawing(const calib::LinkageCycle& cycle);

}  // namespace gdtslam
