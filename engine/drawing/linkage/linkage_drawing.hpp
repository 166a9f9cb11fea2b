// The drawing of a linkage, and what stands beside one in it and in pictures of its motion: name and class, read-outs,
// elevation and transmission angle over the crank with a mark where it stands, the bars' lengths. All sizes follow one
// text size, so that a small picture has fewer things in it, never unreadable ones. One object belongs to one thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calib/linkage/linkage_cycle.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/theme.hpp"

namespace gdtslam {

class Plot;
struct Axis;

inline constexpr double kPoor_deg = 40.0;  ///< calib::kPoorTransmission_rad as people write it

/// Where everything is in a picture; an area without width is left out.
struct LinkageSheet {
  double text = 13.0;  ///< letter size of plain words
  DrawingArea header = {};
  DrawingArea card = {};   ///< under the linkage and the bars' lengths
  DrawingArea scene = {};  ///< the linkage itself
  DrawingArea bars = {};   ///< below it
  DrawingArea figures = {};
  DrawingArea elevation = {};
  DrawingArea transmission = {};
};
/// Of a picture of so many pixels; without a panel, or where one would leave no room, the scene alone.
LinkageSheet linkage_sheet(double width, double height, bool with_panel);

/// One decimal, without a unit and never "-0.0".
std::string degrees_text(double angle_rad);

struct LinkagePanelLook {
  bool is_dark = false;
  bool is_transparent = false;  ///< no page under the cards
  /// A drawing of all positions: its plots begin where the lift does, and name the least transmission angle.
  bool is_still = false;
};

class LinkagePanel {
 public:
  /// `cycle` must outlive this.
  LinkagePanel(const calib::LinkageCycle& cycle, const LinkagePanelLook& look);

  /// Page and cards, then header and bars; the scene is drawn next, over its card.
  void draw_ground(Canvas& canvas, const LinkageSheet& sheet) const;
  void draw_heading(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& card, std::string_view words) const;
  /// Crank, elevation and transmission angle as they are now.
  void draw_figures(Canvas& canvas, const LinkageSheet& sheet, const calib::LinkagePosition& position) const;
  void draw_plots(Canvas& canvas, const LinkageSheet& sheet, const calib::LinkagePosition& position) const;
  /// Where the laser looks at an end of its sweep, beyond the rim; `inner` is nearer to the middle, both of the page.
  void draw_sweep_label(Canvas& canvas, const LinkageSheet& sheet, const Point2& rim, const Point2& inner,
                        double elevation_rad) const;
  /// Where a crank angle lies on the plots' axis, degrees.
  [[nodiscard]] double axis_deg(double crank_rad) const;
  [[nodiscard]] const Theme& theme() const { return theme_; }

 private:
  void draw_header(Canvas& canvas, const LinkageSheet& sheet) const;
  void draw_bars(Canvas& canvas, const LinkageSheet& sheet) const;
  void draw_gauge(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& area, double transmission_rad) const;
  void draw_elevation(Canvas& canvas, const LinkageSheet& sheet, const calib::LinkagePosition& position) const;
  void draw_transmission(Canvas& canvas, const LinkageSheet& sheet, const calib::LinkagePosition& position) const;
  void mark_least(Canvas& canvas, const LinkageSheet& sheet, const Plot& plot) const;
  /// Over the crank, on a card.
  [[nodiscard]] Plot plot_on(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& card, const Axis& y) const;
  void draw_curve(Plot& plot, const LinkageSheet& sheet, const std::vector<Point2>& places, Colour colour,
                  double at_deg) const;
  void shade_strokes(Plot& plot) const;
  /// What the shades mean, at the right of a heading that ends at `from_x`, where there is room.
  void draw_strokes_key(Canvas& canvas, const LinkageSheet& sheet, double from_x) const;

  const calib::LinkageCycle& cycle_;
  LinkagePanelLook look_;
  Theme theme_;
  Colour laser_;                           ///< of the elevation's curve
  Colour laser_text_;                      ///< and of words on the laser
  std::vector<Point2> elevations_deg_;     ///< over the axis
  std::vector<Point2> transmissions_deg_;  ///< likewise
};

/// The linkage as a drawing (1280 by 800): its positions over the lift, the curve of the coupler's middle, the rocker's
/// arc, dead points and the laser's plane; beside it the panel's plots, and the figures that matter. The linkage stands
/// as in the mount: the laser's plane is drawn along the rocker, so elevation 0 is level. The same bytes on every host.
Canvas linkage_drawing(const calib::LinkageCycle& cycle);

}  // namespace gdtslam
