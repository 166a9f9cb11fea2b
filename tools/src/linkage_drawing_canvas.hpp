// The few shapes that a drawing of a linkage is made of, as SVG text. Pixels, x right, y down. One object belongs to
// one thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/pose.hpp"

namespace gdtslam {

/// Colours of the drawing, legible on white. Every bar also carries its name.
namespace ink {
inline constexpr std::string_view kPage = "#f6f5f1";
inline constexpr std::string_view kCard = "#ffffff";
inline constexpr std::string_view kEdge = "#dedbd2";
inline constexpr std::string_view kText = "#22262b";
inline constexpr std::string_view kQuiet = "#68707a";
inline constexpr std::string_view kGrid = "#e9e7e1";
inline constexpr std::string_view kCrank = "#c8471d";
inline constexpr std::string_view kCoupler = "#0069a8";
inline constexpr std::string_view kRocker = "#00795a";
inline constexpr std::string_view kGround = "#4a4f57";
inline constexpr std::string_view kCurve = "#a2559c";
inline constexpr std::string_view kLaser = "#d98b00";
inline constexpr std::string_view kLaserText = "#8a5800";
inline constexpr std::string_view kWarning = "#b3261e";
}  // namespace ink

struct Pen {
  std::string_view colour = ink::kText;
  double width = 1.0;
  double opacity = 1.0;
  std::string_view dashes = "";  ///< as SVG has them
};

struct Lettering {
  double size = 13.0;
  std::string_view colour = ink::kText;
  std::string_view anchor = "start";  ///< start, middle, end
  bool is_bold = false;
  bool has_halo = false;  ///< white around the letters, over lines
};

class Canvas {
 public:
  Canvas(double width, double height, std::string_view title);

  void rectangle(const Point2& corner, double width, double height, std::string_view fill,
                 std::string_view edge = "none", double radius = 0.0);
  void line(const Point2& from, const Point2& to, const Pen& pen);
  void polyline(const std::vector<Point2>& points, const Pen& pen);
  void polygon(const std::vector<Point2>& points, std::string_view fill, double opacity);
  void circle(const Point2& centre, double radius, std::string_view fill, const Pen& pen);
  void text(const Point2& at, std::string_view words, const Lettering& lettering);
  /// Turned by a quarter, to be read from below.
  void upright_text(const Point2& at, std::string_view words, const Lettering& lettering);
  [[nodiscard]] std::string finish() const;

 private:
  void write(const Point2& at, std::string_view words, const Lettering& lettering, bool is_upright);

  std::string svg_;
};

}  // namespace gdtslam
