#include "linkage_model.hpp"

#include <vtkActor.h>
#include <vtkCell.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <cmath>
#include <utility>

#include "linkage_parts.hpp"

namespace gdtslam {
namespace {

std::uint8_t to_byte(double share) { return static_cast<std::uint8_t>(std::lround(share * 255.0)); }

std::array<float, 3> to_floats(const double* xyz) {
  return {static_cast<float>(xyz[0]), static_cast<float>(xyz[1]), static_cast<float>(xyz[2])};
}

Solid make_solid(vtkActor& actor) {
  vtkProperty& look = *actor.GetProperty();
  Solid solid;
  solid.colour = {to_byte(look.GetColor()[0]), to_byte(look.GetColor()[1]), to_byte(look.GetColor()[2])};
  solid.opacity = look.GetOpacity();
  solid.is_lit = look.GetDiffuse() > 0.0;
  vtkPolyData& data = *static_cast<vtkPolyDataMapper*>(actor.GetMapper())->GetInput();
  vtkDataArray& normals = *data.GetPointData()->GetNormals();
  for (vtkIdType k = 0; k < data.GetNumberOfPoints(); ++k) {
    solid.places.push_back(to_floats(data.GetPoint(k)));
    solid.normals.push_back(to_floats(normals.GetTuple3(k)));
  }
  for (vtkIdType k = 0; k < data.GetNumberOfCells(); ++k) {
    vtkCell& cell = *data.GetCell(k);
    solid.triangles.push_back({static_cast<std::uint32_t>(cell.GetPointId(0)),
                               static_cast<std::uint32_t>(cell.GetPointId(1)),
                               static_cast<std::uint32_t>(cell.GetPointId(2))});
  }
  return solid;
}

}  // namespace

std::vector<SolidPart> linkage_solids(const calib::SweepModel& model, int steps) {
  const calib::LinkageCycle cycle(model);
  const LinkageParts parts(model, suitable_sizes(model.bars));
  const LinkageParts::Poses shown = parts.poses_at(Pose3{}, cycle.shown_crank_rad()).value();
  std::vector<SolidPart> solids;
  for (std::size_t k = 0; k < LinkageParts::kCount; ++k) {
    SolidPart part{.name = std::string(LinkageParts::kNames.at(k)), .solids = {}, .poses = {}, .shown = shown.at(k)};
    for (const auto& actor : parts.part(k).actors) part.solids.push_back(make_solid(*actor));
    solids.push_back(std::move(part));
  }
  LinkageParts::Poses last = parts.poses_at(Pose3{}, cycle.begin().crank_rad).value_or(shown);
  for (int step = 0; step <= steps; ++step) {
    // Repeats the last pose if rounding keeps the loop from closing.
    last = parts.poses_at(Pose3{}, cycle.crank_at(static_cast<double>(step) / steps)).value_or(last);
    for (std::size_t k = 0; k < LinkageParts::kCount; ++k) solids[k].poses.push_back(last.at(k));
  }
  return solids;
}

}  // namespace gdtslam
