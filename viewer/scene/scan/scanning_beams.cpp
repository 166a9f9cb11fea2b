#include "scanning_beams.hpp"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>

#include "gdtslam/drawing/colour.hpp"

namespace gdtslam {
namespace {

constexpr Colour kBeam = colour_for(0xb98a35);
constexpr Colour kSheet = colour_for(0xd98b00);
constexpr double kSheetOpacity = 0.08;
constexpr std::size_t kLines = 42;
constexpr double kBefore_m = 0.03;
/// Cosine of 1.5 degrees: neighbours farther apart have beams between them that came back without an answer.
constexpr double kNeighbours = 0.99966;

vtkSmartPointer<vtkActor> new_actor(vtkRenderer& renderer) {
  auto actor = vtkSmartPointer<vtkActor>::New();
  const auto mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
  mapper->SetInputData(vtkSmartPointer<vtkPolyData>::New());
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  renderer.AddActor(actor);
  return actor;
}

void set_data(vtkActor& actor, vtkPolyData* data) {
  static_cast<vtkPolyDataMapper*>(actor.GetMapper())->SetInputData(data);
}

void paint(vtkActor& actor, Colour colour) {
  actor.GetProperty()->SetColor(colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0);
}

}  // namespace

ScanningBeams::ScanningBeams(vtkRenderer& renderer)
    : sheet_(new_actor(renderer)), lines_(new_actor(renderer)), fresh_(new_actor(renderer)) {
  paint(*sheet_, kSheet);
  sheet_->GetProperty()->SetOpacity(kSheetOpacity);
  paint(*lines_, kBeam);
}

void ScanningBeams::set_scan(const Point3& sensor_m, std::span<const CloudPoint> scan) {
  const auto points = vtkSmartPointer<vtkPoints>::New();
  const auto triangles = vtkSmartPointer<vtkCellArray>::New();
  const auto lines = vtkSmartPointer<vtkCellArray>::New();
  points->InsertNextPoint(sensor_m.data());
  Point3 last = Point3::Zero();
  const std::size_t step = std::max<std::size_t>(1, scan.size() / kLines);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Point3 place(scan[i].x_m, scan[i].y_m, scan[i].z_m);
    const auto now = points->InsertNextPoint(place.data());
    const Point3 along = (place - sensor_m).normalized();
    if (i > 0 && along.dot(last) > kNeighbours) {
      triangles->InsertNextCell({vtkIdType{0}, now - 1, now});
    }
    if (i % step == step / 2) lines->InsertNextCell({vtkIdType{0}, now});
    last = along;
  }
  const auto sheet = vtkSmartPointer<vtkPolyData>::New();
  sheet->SetPoints(points);
  sheet->SetPolys(triangles);
  set_data(*sheet_, sheet);
  const auto beams = vtkSmartPointer<vtkPolyData>::New();
  beams->SetPoints(points);
  beams->SetLines(lines);
  set_data(*lines_, beams);
}

void ScanningBeams::set_fresh(const Point3& sensor_m, std::span<const CloudPoint> points, const Fading& fading) {
  const auto places = vtkSmartPointer<vtkPoints>::New();
  const auto cells = vtkSmartPointer<vtkCellArray>::New();
  const auto colours = vtkSmartPointer<vtkUnsignedCharArray>::New();
  colours->SetNumberOfComponents(3);
  for (const CloudPoint& point : points) {
    const double age = std::clamp((fading.now_s - point.stamp_s) / fading.fades_s, 0.0, 1.0);
    // Before the same point of the cloud, which is a disc of some size.
    const Point3 place(point.x_m, point.y_m, point.z_m);
    const Point3 before = place - kBefore_m * (place - sensor_m).normalized();
    const auto id = places->InsertNextPoint(before.data());
    cells->InsertNextCell({id});
    colours->InsertNextTuple3(255.0, 255.0 - 35.0 * age, 245.0 - 115.0 * age);
  }
  const auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(places);
  data->SetVerts(cells);
  data->GetPointData()->SetScalars(colours);
  set_data(*fresh_, data);
  fresh_->GetProperty()->SetPointSize(static_cast<float>(fading.size_px));
}

}  // namespace gdtslam
