#include "scanning_scene.hpp"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "viewer/graphics/offscreen_view.hpp"
#include "viewer/scene/cloud/cloud_path.hpp"
#include "viewer/scene/cloud/cloud_points.hpp"
#include "viewer/scene/cloud/cloud_values.hpp"
#include "viewer/scene/linkage/mount_model.hpp"

namespace gdtslam {
namespace {

constexpr double kCube_m = 0.08;          ///< for measuring the density of points
constexpr double kMostDiameter_m = 0.03;  ///< diameter of an isolated point
constexpr double kFades_s = 0.3;
constexpr double kPathWidth_m = 0.014;
constexpr double kGridStep_m = 1.0;
constexpr int kMostGridLines = 120;
constexpr Colour kBeam = colour_for(0xb98a35);
constexpr Colour kSheet = colour_for(0xd98b00);
constexpr double kSheetOpacity = 0.08;
constexpr std::size_t kLines = 42;
constexpr double kCutAway_m = std::numeric_limits<double>::infinity();
constexpr double kBefore_m = 0.03;
/// Cosine of 1.5 degrees: between neighbours farther apart there are beams without a return.
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

struct Fading {
  double now_s = 0.0;
  double fades_s = 0.3;
  double size_px = 2.0;
};

/// The beams of one scan from the sensor to their hits, and the newest points brighter than the rest. O(points) per
/// call.
class ScanningBeams {
 public:
  explicit ScanningBeams(vtkRenderer& renderer)
      : sheet_(new_actor(renderer)), lines_(new_actor(renderer)), fresh_(new_actor(renderer)) {
    paint(*sheet_, kSheet);
    sheet_->GetProperty()->SetOpacity(kSheetOpacity);
    paint(*lines_, kBeam);
  }
  /// A sheet through all the scan's points in the order of the beams, with gaps at missing beams, and some of the beams
  /// as lines.
  void set_scan(const Point3& sensor_m, std::span<const CloudPoint> scan) {
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
  /// The newest points; older ones fade to the colour of the beams.
  void set_fresh(const Point3& sensor_m, std::span<const CloudPoint> points, const Fading& fading) {
    const auto places = vtkSmartPointer<vtkPoints>::New();
    const auto cells = vtkSmartPointer<vtkCellArray>::New();
    const auto colours = vtkSmartPointer<vtkUnsignedCharArray>::New();
    colours->SetNumberOfComponents(3);
    for (const CloudPoint& point : points) {
      const double age = std::clamp((fading.now_s - point.stamp_s) / fading.fades_s, 0.0, 1.0);
      // In front of the same point of the cloud, which is a disc of some size.
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

 private:
  vtkSmartPointer<vtkActor> sheet_;
  vtkSmartPointer<vtkActor> lines_;
  vtkSmartPointer<vtkActor> fresh_;
};

/// Lines a metre apart on the floor, below everything shown.
Mesh floor_grid(const Bounds& bounds) {
  std::vector<std::vector<Point3>> lines;
  const auto round_down = [](double value) { return kGridStep_m * (std::floor(value / kGridStep_m) - 1.0); };
  const Point2 low(round_down(bounds.lowest.x()), round_down(bounds.lowest.y()));
  const Point2 high(-round_down(-bounds.highest.x()), -round_down(-bounds.highest.y()));
  const Point2 count = (high - low) / kGridStep_m;
  constexpr double kHalf_m = 0.006;
  if (count.x() + count.y() > kMostGridLines) return tubes({}, kHalf_m);
  for (double x = low.x(); x < high.x() + 0.5 * kGridStep_m; x += kGridStep_m) {
    lines.push_back({{x, low.y(), 0.0}, {x, high.y(), 0.0}});
  }
  for (double y = low.y(); y < high.y() + 0.5 * kGridStep_m; y += kGridStep_m) {
    lines.push_back({{low.x(), y, 0.0}, {high.x(), y, 0.0}});
  }
  return tubes(lines, kHalf_m);
}

}  // namespace

struct ScanningScene::State {
  State(const GraphicsContext& graphics, const ScanningTrack& with_track, const calib::SweepModel& model,
        bool has_linkage, const Trajectory& trajectory, const CloudLook& with_look)
      : track(with_track),
        look(with_look),
        view(graphics),
        path(view.renderer(), with_look.is_dark),
        beams(view.renderer()),
        robot(&model, has_linkage, {track.sensor_forward_m(model.mount), 0.0, 0.0}) {
    view.set_background(look.is_dark ? ink::kNight : ink::kPage, look.is_transparent);
    view.set_eye_dome(look.with_eye_dome);
    view.set_samples(look.samples);
    view.set_layer(&points);
    add_lights(view.renderer());
    robot.add_to(view.renderer());
    set_points();
    path.set(trajectory, [](const Point2&) { return 0.0; });
  }

  void set_points() {
    const std::span<const CloudPoint> cloud = track.points();
    const LevelSurfaces surfaces = sampled_level_surfaces(cloud);
    std::vector<std::uint32_t> drawn = drawn_points(cloud, surfaces, look);
    Bounds bounds = robust_bounds(cloud, drawn);
    const CloudValues values(look.colour, cloud, {});
    scale = colour_scale(look, values, drawn);
    const ColourMap& map = colour_map(scale.colour_map);
    const bool is_plain = look.colour == CloudColour::kPlain;
    const CloudDensity density(cloud, drawn, kCube_m);
    points.set(cloud, std::move(drawn), [&](std::uint32_t k) {
      return CloudPoints::Look{.colour = is_plain ? plain_colour(look) : colour_at(scale, map, values.at(k)),
                               .diameter_m = static_cast<float>(
                                   std::min(1.5 * static_cast<double>(density.spacing_m(cloud[k])), kMostDiameter_m))};
    });
    for (const double stamp_s : {track.from_s(), track.to_s()}) {
      const Pose2 pose = track.T_map_base(stamp_s);
      bounds.add({pose.x_m, pose.y_m, 0.0});
    }
    const auto grid = make_actor(floor_grid(bounds), look.is_dark ? colour_for(0x2a3039) : ink::kEdge, Finish::kFlat);
    view.renderer().AddActor(grid);
  }

  const ScanningTrack& track;
  CloudLook look;
  CloudPoints points;
  OffscreenView view;
  CloudPath path;
  ScanningBeams beams;
  MountModel robot;
  ColourScale scale;
};

ScanningScene::ScanningScene(const GraphicsContext& graphics, const ScanningTrack& track,
                             const calib::SweepModel& model, bool has_linkage, const Trajectory& trajectory,
                             const CloudLook& look)
    : state_(std::make_unique<State>(graphics, track, model, has_linkage, trajectory, look)) {}

ScanningScene::~ScanningScene() = default;

void ScanningScene::show(double stamp_s, double crank_rad) {
  State& s = *state_;
  s.points.show_until(stamp_s);
  s.path.show_until(stamp_s);
  s.robot.place(s.track.T_map_base(stamp_s));
  if (s.robot.has_linkage()) {
    s.robot.set_crank(crank_rad);
  } else {
    s.robot.set_elevation(s.track.elevation_rad(stamp_s));
  }
  const Point3 sensor_m = s.robot.T_map_laser().translation_m;
  // Everything in front of the robot is cut away, because a moving hole in a wall would distract.
  s.points.keep_in_view(KeptInView{{sensor_m.x(), sensor_m.y(), 0.5 * sensor_m.z()}, kCutAway_m});
  s.beams.set_scan(sensor_m, s.track.last_scan(stamp_s));
  s.beams.set_fresh(sensor_m, s.track.measured_between(stamp_s - kFades_s, stamp_s),
                    {.now_s = stamp_s, .fades_s = kFades_s, .size_px = 2.0 * s.look.samples});
}

std::uint64_t ScanningScene::points_drawn() const { return state_->points.shown(); }
const ColourScale& ScanningScene::scale() const { return state_->scale; }
Pose3 ScanningScene::T_map_laser() const { return state_->robot.T_map_laser(); }

RgbaImage ScanningScene::render(const Camera& camera, const PictureSize& size) {
  State& s = *state_;
  s.points.set_sizes({.least_px = 1.0, .largest_px = std::max(2.0, size.height / 60.0), .samples = s.look.samples});
  s.path.prepare(kPathWidth_m);
  return s.view.render(camera, size);
}

}  // namespace gdtslam
