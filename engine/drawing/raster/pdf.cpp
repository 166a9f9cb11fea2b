#include <cairo-pdf.h>

#include "cairo_painter.hpp"
#include "gdtslam/drawing/raster.hpp"

namespace gdtslam {
namespace {

constexpr double kPointsPerPixel = 72.0 / 96.0;

cairo_status_t append(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::string pdf_of(const Canvas& drawing) {
  std::string bytes;
  const CairoSurface surface(cairo_pdf_surface_create_for_stream(&append, &bytes, drawing.width() * kPointsPerPixel,
                                                                 drawing.height() * kPointsPerPixel));
  check_cairo(cairo_surface_status(surface.get()), "making a PDF");
  // The same drawing gives the same bytes: without the time of day that Cairo would write.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, drawing.title().c_str());
  {
    const CairoContext context(cairo_create(surface.get()));
    cairo_scale(context.get(), kPointsPerPixel, kPointsPerPixel);
    CairoPainter painter(context.get());
    for (const Shape& shape : drawing.shapes()) std::visit(painter, shape);
    cairo_show_page(context.get());
    check_cairo(cairo_status(context.get()), "drawing a PDF");
  }
  cairo_surface_finish(surface.get());
  check_cairo(cairo_surface_status(surface.get()), "writing a PDF");
  return bytes;
}

}  // namespace gdtslam
