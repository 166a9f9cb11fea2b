// Points as a prop of VTK with OpenGL buffers of their own: 16 bytes a point and nothing else, where VTK's mappers
// keep several copies. Each piece waits in memory until the first picture and lives in OpenGL alone afterwards.
#pragma once

#include <vtkProp.h>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "gdtslam/viewer/camera.hpp"

namespace gdtslam {

/// As OpenGL reads it.
struct DotVertex {
  std::array<float, 3> place;  ///< from the prop's origin, metres
  std::array<std::uint8_t, 3> colour;
  std::uint8_t size_code;  ///< see diameter_code()
};
static_assert(sizeof(DotVertex) == 16);

/// Diameters in space in 8 bits, each 3.5 % larger than the one before: 1 mm to 6.9 m.
std::uint8_t diameter_code(double diameter_m);

class CloudPointsProp : public vtkProp {
 public:
  // clang-format off: the macro ends without a semicolon
  vtkTypeMacro(CloudPointsProp, vtkProp) static CloudPointsProp* New();
  // clang-format on
  CloudPointsProp(const CloudPointsProp&) = delete;
  CloudPointsProp& operator=(const CloudPointsProp&) = delete;

  /// Before the first piece.
  void set_origin(const Point3& origin) { origin_ = origin; }
  void add_piece(std::vector<DotVertex> dots);
  void show(std::size_t piece, std::size_t first_dots) { pieces_[piece].shown = first_dots; }
  /// Pixels of a disc of a metre: at one metre's distance, or of a parallel camera anywhere; and the least and the
  /// largest size that is drawn.
  void set_sizes(double metre_px, double least_px, double largest_px);
  /// A place that no point nearer to a perspective camera hides: those in a cone around it are left
  /// out, but for what lies lower than it: the floor.
  void keep_in_view(const std::optional<Point3>& place) { kept_in_view_ = place; }

  double* GetBounds() override;
  int RenderOpaqueGeometry(vtkViewport* viewport) override;
  void ReleaseGraphicsResources(vtkWindow* window) override;

 protected:
  CloudPointsProp() = default;
  ~CloudPointsProp() override = default;  // the window has released the buffers by then

 private:
  struct Piece {
    std::vector<DotVertex> waiting;
    std::uint32_t buffer = 0;
    std::size_t shown = 0;
  };
  void bind(Piece& piece, std::int32_t place_at, std::int32_t colour_at);

  Point3 origin_ = Point3::Zero();
  Bounds bounds_;
  std::array<double, 6> vtk_bounds_{};
  std::vector<Piece> pieces_;
  std::uint32_t layout_ = 0;  ///< vertex array object
  std::optional<Point3> kept_in_view_;
  float metre_px_ = 1.0F;
  std::array<float, 2> range_px_{1.0F, 1.0F};
};

}  // namespace gdtslam
