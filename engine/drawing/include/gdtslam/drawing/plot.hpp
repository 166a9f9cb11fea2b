// Plots: axes with round ticks, and curves, bands, markers, steps and boxes between them. All sizes follow the text
// size. Values are the caller's units, the page is pixels. One object belongs to one thread; O(values).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam {

/// One axis: its range, its ticks and its words.
struct Axis {
  std::string title = {};  ///< with the unit: "time in s"
  double from = 0.0;
  double to = 1.0;
  TickSteps steps = TickSteps::kDecimal;
  bool is_grown = false;  ///< extended outwards to whole ticks
  bool has_grid = true;
  /// Named positions instead of ticks: groups of a box plot.
  std::vector<std::pair<double, std::string>> names = {};
  /// Text after each name. If room is short, the name is shortened first.
  std::vector<std::string> remarks = {};
};

/// Title, size of letters and colours of a plot.
struct PlotLook {
  std::string title = {};  ///< above the frame; empty: takes no room
  double text_size = 13.0;
  Theme theme = kLightTheme;
  bool has_frame = true;  ///< else only the lower and left edge
};

/// Five figures of a distribution: quartiles interpolated between the two nearest values, whiskers at the outermost
/// values within 1.5 times the quartiles' distance [Tukey1977].
struct BoxFigures {
  double low_whisker = 0.0;
  double lower_quartile = 0.0;
  double median = 0.0;
  double upper_quartile = 0.0;
  double high_whisker = 0.0;
  std::vector<double> beyond;  ///< values beyond the whiskers, ascending
};
/// Figures of at least one value, all finite, in any order. O(n log n).
BoxFigures box_figures(std::vector<double> values);

/// The constructor draws the axes; the other calls draw within the frame. Values that are not finite leave a gap. A
/// curve with a name gets an entry in the legend.
class Plot {
 public:
  /// `area` contains everything: words, frame, ticks.
  Plot(Canvas& canvas, const DrawingArea& area, Axis x, Axis y, PlotLook look = {});

  /// Position of a value on the page, also outside the frame.
  [[nodiscard]] Point2 at(double x, double y) const;
  /// The frame.
  [[nodiscard]] const DrawingArea& inside() const { return inside_; }

  void line(std::span<const Point2> values, const Pen& pen, std::string_view name = {});
  /// Step curve that is flat from each value to the next one, like a distribution function.
  void steps(std::span<const Point2> values, const Pen& pen, std::string_view name = {});
  void markers(std::span<const Point2> values, const Fill& fill, double radius = 2.5, std::string_view name = {});
  /// Band between two curves with the same x and equal numbers of points.
  void band(std::span<const Point2> lower, std::span<const Point2> upper, const Fill& fill, std::string_view name = {});
  /// Fills the full height of the frame between two x.
  void stretch(double from_x, double to_x, const Fill& fill, std::string_view name = {});
  /// Lines over the full width or height of the frame.
  void level(double y, const Pen& pen, std::string_view name = {});
  void upright(double x, const Pen& pen, std::string_view name = {});
  /// A box with whiskers around x, `width` of x wide.
  void box(double x, double width, const BoxFigures& figures, Colour colour);
  /// Words at a value, moved by some pixels.
  void words(double x, double y, std::string_view text, const Lettering& lettering, const Point2& by = Point2::Zero());

  /// Draws the legend where it hides least; call it last. Without names it draws nothing.
  void legend();

 private:
  enum class Mark : std::uint8_t { kLine, kDot, kArea };
  struct Entry {
    std::string name;
    Mark mark = Mark::kLine;
    Pen pen;
    Fill fill;
  };
  /// Words beside an axis.
  struct Label {
    double value = 0.0;
    std::string text;
    std::size_t kept = 0;  ///< bytes at the end that are the remark
  };
  static std::vector<Label> make_labels(const Axis& axis, const Ticks& ticks);
  [[nodiscard]] double letters() const;
  [[nodiscard]] double widest(const std::vector<Label>& labels) const;
  void lay_out_y();
  void lay_out_x();
  /// Pixels between the two nearest labels of the x axis.
  [[nodiscard]] double label_distance() const;
  void draw_axes();
  void draw_x_axis();
  void draw_y_axis();
  void draw_titles();
  void begin_clip();
  /// Marks a position, or all along a line, as covered, so that the legend avoids it.
  void cover(const Point2& place);
  void cover(const Point2& from, const Point2& to);
  void explain(std::string_view name, Mark mark, const Pen& pen, const Fill& fill);
  [[nodiscard]] Point2 place_of_legend(double width, double height) const;
  /// Draws the names of groups in two rows, shortened to the available room.
  void fit_names(double distance);
  void draw_entry(const Entry& entry, const Point2& at, double size);

  Canvas& canvas_;
  DrawingArea area_;
  DrawingArea inside_;
  Axis x_;
  Axis y_;
  PlotLook look_;
  std::vector<Label> x_labels_;
  std::vector<Label> y_labels_;
  int label_rows_ = 1;  ///< below the frame; two if names would overlap
  std::vector<Entry> entries_;
  std::vector<Point2> covered_;
};

}  // namespace gdtslam
