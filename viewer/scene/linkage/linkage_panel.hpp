// What stands beside a moving linkage: name and class, read-outs, elevation and transmission angle over the crank with
// a mark that runs along, the bars' lengths. All sizes follow one text size, so that a small picture has fewer things
// in it, never unreadable ones. `gdtslam linkage --svg` draws the same curves
// (tools/gdtslam/drawings/linkage_drawing_plots.cpp) over the crank since the lift began; both use drawing/plot.hpp.
// One object belongs to one thread.
#pragma once

#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "gdtslam/viewer/camera.hpp"
#include "gdtslam/viewer/linkage_scene.hpp"
#include "linkage_cycle.hpp"

namespace gdtslam {

class Plot;

/// Where everything is in a picture; an area without width is left out.
struct LinkageSheet {
  double text = 13.0;  ///< letter size of plain words
  DrawingArea header;
  DrawingArea scene;
  DrawingArea bars;  ///< below the scene, in its card
  DrawingArea figures;
  DrawingArea elevation;
  DrawingArea transmission;

  [[nodiscard]] PictureSize scene_size() const;
};
LinkageSheet sheet_for(const PictureSize& size, bool with_panel);

class LinkagePanel {
 public:
  LinkagePanel(const LinkageCycle& cycle, const LinkageLook& look);

  /// Page and cards, then header and bars; the scene is drawn next, over its card.
  void draw_ground(Canvas& canvas, const LinkageSheet& sheet) const;
  void draw_read_outs(Canvas& canvas, const LinkageSheet& sheet, const LinkagePosition& position) const;
  /// Where a crank angle lies on the plots' axis, degrees.
  [[nodiscard]] double axis_deg(double crank_rad) const;
  [[nodiscard]] const Theme& theme() const { return theme_; }

 private:
  struct Figure;
  struct CurveOfCrank;
  void draw_header(Canvas& canvas, const LinkageSheet& sheet) const;
  void draw_bars(Canvas& canvas, const LinkageSheet& sheet) const;
  void draw_figures(Canvas& canvas, const LinkageSheet& sheet, const LinkagePosition& position) const;
  void draw_gauge(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& area, double transmission_rad) const;
  void draw_elevation(Canvas& canvas, const LinkageSheet& sheet, const LinkagePosition& position) const;
  void draw_transmission(Canvas& canvas, const LinkageSheet& sheet, const LinkagePosition& position) const;
  void draw_curve(Canvas& canvas, const LinkageSheet& sheet, const CurveOfCrank& curve, double crank_rad) const;
  void shade_strokes(Plot& plot) const;
  void draw_card(Canvas& canvas, const DrawingArea& area) const;
  /// Heading of a card; the room below it.
  DrawingArea headed(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& card, std::string_view words) const;
  /// What the shades mean, at the right of a heading that ends at `from_x`, where there is room.
  void draw_strokes_key(Canvas& canvas, const LinkageSheet& sheet, const DrawingArea& card, double from_x) const;

  const LinkageCycle& cycle_;
  LinkageLook look_;
  Theme theme_;
  std::vector<Point2> elevations_deg_;     ///< over the axis
  std::vector<Point2> transmissions_deg_;  ///< likewise
};

}  // namespace gdtslam
