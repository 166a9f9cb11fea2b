#include "cloud_map.hpp"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <array>

#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {
namespace {

// Calls with row, first and end column, and state of each stretch of known cells.
template <class Visit>
void for_each_stretch(const OccupancyMap& map, const Visit& visit) {
  for (std::int32_t y = 0; y < map.geometry.height; ++y) {
    for (std::int32_t x = 0; x < map.geometry.width;) {
      const CellState state = map.at({x, y});
      const std::int32_t begin = x;
      while (x < map.geometry.width && map.at({x, y}) == state) ++x;
      if (state != CellState::kUnknown) visit(y, begin, x, state);
    }
  }
}

Point3 corner_of(const GridGeometry& grid, std::int32_t x, std::int32_t y, double height_m) {
  return {grid.origin_x_m + x * grid.resolution_m, grid.origin_y_m + y * grid.resolution_m, height_m};
}

}  // namespace

vtkSmartPointer<vtkActor> map_actor(const OccupancyMap& map, double height_m, bool is_dark) {
  const Colour free = is_dark ? colour_for(0x262b33) : colour_for(0xebe9e3);
  const Colour occupied = is_dark ? colour_for(0x98a2b0) : colour_for(0x3a3f46);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> colours;
  colours->SetNumberOfComponents(3);
  for_each_stretch(map, [&](std::int32_t y, std::int32_t begin, std::int32_t end, CellState state) {
    std::array<vtkIdType, 4> ids{};
    const std::array<std::array<std::int32_t, 2>, 4> corners{{{begin, y}, {end, y}, {end, y + 1}, {begin, y + 1}}};
    for (std::size_t k = 0; k < 4; ++k) {
      ids[k] = points->InsertNextPoint(corner_of(map.geometry, corners[k][0], corners[k][1], height_m).data());
    }
    cells->InsertNextCell(4, ids.data());
    const Colour colour = state == CellState::kFree ? free : occupied;
    const std::array<unsigned char, 3> rgb{colour.red, colour.green, colour.blue};
    colours->InsertNextTypedTuple(rgb.data());
  });
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(cells);
  data->GetCellData()->SetScalars(colours);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  mapper->SetColorModeToDirectScalars();
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  return actor;
}

Bounds map_bounds(const OccupancyMap& map, double height_m) {
  Bounds bounds;
  for_each_stretch(map, [&](std::int32_t y, std::int32_t begin, std::int32_t end, CellState /*state*/) {
    bounds.add(corner_of(map.geometry, begin, y, height_m));
    bounds.add(corner_of(map.geometry, end, y + 1, height_m));
  });
  return bounds;
}

}  // namespace gdtslam
