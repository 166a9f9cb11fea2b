// Small scenes for the tests of the headless graphics.
#pragma once

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>

#include <cmath>
#include <vector>

#include "viewer/graphics/offscreen_view.hpp"

namespace gdtslam::test {

inline const Colour kRed{230, 40, 10};
inline const Colour kGreen{20, 200, 60};
inline const Colour kGrey{60, 70, 80};

/// Points (one), or a filled polygon (three and more), in one flat colour.
inline vtkActor* add_shape(OffscreenView& view, const std::vector<Point3>& corners, Colour colour,
                           double opacity = 1.0) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cell;
  cell->InsertNextCell(static_cast<int>(corners.size()));
  for (const Point3& corner : corners) {
    cell->InsertCellPoint(points->InsertNextPoint(corner.x(), corner.y(), corner.z()));
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  if (corners.size() == 1) {
    data->SetVerts(cell);
  } else {
    data->SetPolys(cell);
  }
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetColor(colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0);
  actor->GetProperty()->SetOpacity(opacity);
  actor->GetProperty()->SetPointSize(static_cast<float>(5 * view.samples()));
  view.renderer().AddActor(actor);
  return actor;
}

inline bool is_near(const std::uint8_t* pixel, Colour colour, int tolerance = 2) {
  return std::abs(pixel[0] - colour.red) <= tolerance && std::abs(pixel[1] - colour.green) <= tolerance &&
         std::abs(pixel[2] - colour.blue) <= tolerance;
}

/// The pixels of one colour: how many, their centre (pixel centres at halves).
struct Spot {
  double count = 0.0;
  double x = 0.0;
  double y = 0.0;
};
inline Spot spot_of(const RgbaImage& image, Colour colour) {
  Spot spot;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      if (!is_near(image.at(x, y), colour)) continue;
      spot.count += 1.0;
      spot.x += x + 0.5;
      spot.y += y + 0.5;
    }
  }
  if (spot.count > 0.0) {
    spot.x /= spot.count;
    spot.y /= spot.count;
  }
  return spot;
}

/// A square upright before a camera that looks along +y: centre, half side.
inline std::vector<Point3> upright_square(const Point3& centre, double half) {
  return {centre + Point3(-half, 0, -half), centre + Point3(half, 0, -half), centre + Point3(half, 0, half),
          centre + Point3(-half, 0, half)};
}

inline Camera camera_along_y(bool is_parallel) {
  Camera camera;
  camera.eye = {0.0, 0.0, 0.0};
  camera.target = {0.0, 10.0, 0.0};
  camera.is_parallel = is_parallel;
  camera.parallel_height_m = 6.0;
  return camera;
}

}  // namespace gdtslam::test
