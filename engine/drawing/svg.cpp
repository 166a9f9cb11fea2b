#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "engine/core/base64.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "markup.hpp"

namespace gdtslam {
namespace {

// A pixel to its hundredth; never "-0.00".
std::string pixels(double value) {
  return fmt::format("{:.2f}", value + 0.0 == 0.0 || (value > -0.005 && value < 0) ? 0.0 : value);
}

std::string stroke(const Pen& pen) {
  std::string text = fmt::format("stroke=\"{}\" stroke-width=\"{}\"", hex_text(pen.colour), pixels(pen.width));
  if (pen.opacity < 1.0) {
    text += fmt::format(" stroke-opacity=\"{}\"", pixels(pen.opacity));
  }
  if (!pen.dashes.empty()) {
    text += fmt::format(" stroke-dasharray=\"{}\"", pen.dashes);
  }
  return text;
}

std::string places(const std::vector<Point2>& points) {
  std::string text;
  for (const Point2& point : points) {
    text += fmt::format("{}{},{}", text.empty() ? "" : " ", pixels(point.x()), pixels(point.y()));
  }
  return text;
}

/// The inside of a rectangle or circle.
std::string filling(const std::optional<Fill>& fill) {
  if (!fill) return "fill=\"none\"";
  std::string text = fmt::format("fill=\"{}\"", hex_text(fill->colour));
  if (fill->opacity < 1.0) text += fmt::format(" fill-opacity=\"{}\"", pixels(fill->opacity));
  return text;
}

/// A rectangle's edge; the usual one, a pixel wide, is SVG's default.
std::string edging(const std::optional<Pen>& edge) {
  if (!edge) return "stroke=\"none\"";
  const bool is_usual = edge->width == 1.0 && edge->opacity >= 1.0 && edge->dashes.empty();
  return is_usual ? fmt::format("stroke=\"{}\"", hex_text(edge->colour)) : stroke(*edge);
}

/// Writes one shape after the other. A clip is a nested <svg>, which hides what leaves it: a clipPath would need a
/// name, and two drawings in one page would share it.
class SvgWriter {
 public:
  SvgWriter(std::string& svg, const PngEncoder& png) : svg_(svg), png_(png) {}

  void operator()(const shape::Rectangle& box) {
    svg_ += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{}\" {} {}/>\n",
                        pixels(box.corner.x()), pixels(box.corner.y()), pixels(box.width), pixels(box.height),
                        pixels(box.radius), filling(box.fill), edging(box.edge));
  }
  void operator()(const shape::Line& line) {
    const std::vector<Point2>& points = line.points;
    if (points.size() == 2) {
      svg_ += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {}/>\n", pixels(points[0].x()),
                          pixels(points[0].y()), pixels(points[1].x()), pixels(points[1].y()), stroke(line.pen));
    } else {
      svg_ += fmt::format("<polyline points=\"{}\" fill=\"none\" {}/>\n", places(points), stroke(line.pen));
    }
  }
  void operator()(const shape::Polygon& polygon) {
    svg_ += fmt::format("<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"{}\"/>\n", places(polygon.points),
                        hex_text(polygon.fill.colour), pixels(polygon.fill.opacity));
  }
  void operator()(const shape::Circle& circle) {
    svg_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {}", pixels(circle.centre.x()), pixels(circle.centre.y()),
                        pixels(circle.radius), filling(circle.fill));
    if (circle.edge) svg_ += " " + stroke(*circle.edge);
    svg_ += "/>\n";
  }
  void operator()(const shape::Words& words) {
    constexpr std::string_view kAnchors[] = {"start", "middle", "end"};
    const Lettering& lettering = words.lettering;
    const std::string x = pixels(words.at.x());
    const std::string y = pixels(words.at.y());
    svg_ += fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\" text-anchor=\"{}\"", x, y,
                        pixels(lettering.size), hex_text(lettering.colour),
                        kAnchors[static_cast<std::size_t>(lettering.anchor)]);
    if (lettering.is_bold) svg_ += " font-weight=\"600\"";
    if (lettering.has_halo) {
      svg_ += fmt::format(" stroke=\"{}\" stroke-width=\"4\" paint-order=\"stroke\"", hex_text(lettering.halo));
    }
    if (words.is_upright) svg_ += fmt::format(" transform=\"rotate(-90 {} {})\"", x, y);
    svg_ += ">" + markup_text(words.text) + "</text>\n";
  }
  void operator()(const shape::Picture& picture) {
    if (!png_) {
      throw Error(ExitCode::kFailed, "a drawing with a picture cannot become SVG without a PNG encoder: give one");
    }
    svg_ += fmt::format("<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\"{} href=\"",
                        pixels(picture.corner.x()), pixels(picture.corner.y()), pixels(picture.width),
                        pixels(picture.height), picture.is_smooth ? "" : " style=\"image-rendering:pixelated\"");
    const std::string png = png_(*picture.image);
    svg_ += "data:image/png;base64,";
    append_base64(std::as_bytes(std::span(png)), svg_);
    svg_ += "\"/>\n";
  }
  void operator()(const shape::ClipBegin& clip) {
    svg_ += fmt::format("<svg x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" viewBox=\"{0} {1} {2} {3}\">\n",
                        pixels(clip.corner.x()), pixels(clip.corner.y()), pixels(clip.width), pixels(clip.height));
    ++open_clips_;
  }
  void operator()(const shape::ClipEnd&) {
    if (open_clips_ == 0) return;
    svg_ += "</svg>\n";
    --open_clips_;
  }
  void close_clips() {
    while (open_clips_ > 0) (*this)(shape::ClipEnd{});
  }

 private:
  std::string& svg_;
  const PngEncoder& png_;
  int open_clips_ = 0;
};

}  // namespace

std::string svg_of(const Canvas& drawing, const PngEncoder& png) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
      "font-family=\"Inter, 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif\" stroke-linecap=\"round\" "
      "stroke-linejoin=\"round\">\n<title>{2}</title>\n",
      drawing.width(), drawing.height(), markup_text(drawing.title()));
  SvgWriter writer(svg, png);
  for (const Shape& shape : drawing.shapes()) std::visit(writer, shape);
  writer.close_clips();
  return svg + "</svg>\n";
}

}  // namespace gdtslam
