#include "linkage_drawing_canvas.hpp"

#include <fmt/format.h>

namespace gdtslam {
namespace {

std::string escaped(std::string_view words) {
  std::string result;
  for (const char letter : words) {
    switch (letter) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        // Control characters are not allowed in XML at all.
        result += static_cast<unsigned char>(letter) < 0x20 ? ' ' : letter;
    }
  }
  return result;
}

// A pixel to its hundredth; never "-0.00".
std::string pixels(double value) {
  return fmt::format("{:.2f}", value + 0.0 == 0.0 || (value > -0.005 && value < 0) ? 0.0 : value);
}

std::string stroke(const Pen& pen) {
  std::string text = fmt::format("stroke=\"{}\" stroke-width=\"{}\"", pen.colour, pixels(pen.width));
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

}  // namespace

Canvas::Canvas(double width, double height, std::string_view title) {
  svg_ = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
      "font-family=\"Inter, 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif\" stroke-linecap=\"round\" "
      "stroke-linejoin=\"round\">\n<title>{2}</title>\n",
      width, height, escaped(title));
  rectangle({0.0, 0.0}, width, height, ink::kPage);
}

void Canvas::rectangle(const Point2& corner, double width, double height, std::string_view fill, std::string_view edge,
                       double radius) {
  svg_ +=
      fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"{}\" fill=\"{}\" stroke=\"{}\"/>\n",
                  pixels(corner.x()), pixels(corner.y()), pixels(width), pixels(height), pixels(radius), fill, edge);
}

void Canvas::line(const Point2& from, const Point2& to, const Pen& pen) {
  svg_ += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" {}/>\n", pixels(from.x()), pixels(from.y()),
                      pixels(to.x()), pixels(to.y()), stroke(pen));
}

void Canvas::polyline(const std::vector<Point2>& points, const Pen& pen) {
  svg_ += fmt::format("<polyline points=\"{}\" fill=\"none\" {}/>\n", places(points), stroke(pen));
}

void Canvas::polygon(const std::vector<Point2>& points, std::string_view fill, double opacity) {
  svg_ +=
      fmt::format("<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"{}\"/>\n", places(points), fill, pixels(opacity));
}

void Canvas::circle(const Point2& centre, double radius, std::string_view fill, const Pen& pen) {
  svg_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{}\" {}/>\n", pixels(centre.x()), pixels(centre.y()),
                      pixels(radius), fill, stroke(pen));
}

void Canvas::text(const Point2& at, std::string_view words, const Lettering& lettering) {
  write(at, words, lettering, false);
}

void Canvas::upright_text(const Point2& at, std::string_view words, const Lettering& lettering) {
  write(at, words, lettering, true);
}

void Canvas::write(const Point2& at, std::string_view words, const Lettering& lettering, bool is_upright) {
  const std::string x = pixels(at.x());
  const std::string y = pixels(at.y());
  svg_ += fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\" text-anchor=\"{}\"", x, y,
                      pixels(lettering.size), lettering.colour, lettering.anchor);
  if (lettering.is_bold) {
    svg_ += " font-weight=\"600\"";
  }
  if (lettering.has_halo) {
    svg_ += " stroke=\"#ffffff\" stroke-width=\"4\" paint-order=\"stroke\"";
  }
  if (is_upright) {
    svg_ += fmt::format(" transform=\"rotate(-90 {} {})\"", x, y);
  }
  svg_ += ">" + escaped(words) + "</text>\n";
}

std::string Canvas::finish() const { return svg_ + "</svg>\n"; }

}  // namespace gdtslam
