#include "scene/cloud_points.hpp"

#include <GL/glew.h>
#include <vtkActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkOpenGLPolyDataMapper.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkShaderProgram.h>
#include <vtkShaderProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gdtslam/core/elementary.hpp"
#include "scene/camera_basis.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kPiece = 1U << 16U;
// Diameters in space are kept in 8 bits, each 3.5 % larger than the one before: 1 mm to 6.9 m.
constexpr double kLeastDiameter_m = 0.001;
constexpr double kDiametersPerDoubling = 20.0;

// The size of a point in space over its depth; w is the depth of a perspective camera and 1 of a parallel one. What is
// not shown yet goes behind the camera. The alpha of a point's colour is its size, not its opacity.
constexpr const char* kSizeDeclaration =
    "//VTK::PositionVC::Dec\n"
    "uniform int dots_shown;\n"
    "uniform float dot_scale_px;\n"
    "uniform vec2 dot_range_px;\n";
constexpr const char* kSizeCode =
    "//VTK::PositionVC::Impl\n"
    "  float dot_diameter_m = 0.001 * exp2(scalarColor.a * (255.0 / 20.0));\n"
    "  gl_PointSize = clamp(dot_scale_px * dot_diameter_m / gl_Position.w, dot_range_px.x, dot_range_px.y);\n"
    "  if (gl_VertexID >= dots_shown) gl_Position = vec4(0.0, 0.0, -2.0, 1.0);\n";
constexpr const char* kRoundCode =
    "//VTK::Color::Impl\n"
    "  vec2 dot_place = gl_PointCoord - vec2(0.5);\n"
    "  if (dot(dot_place, dot_place) > 0.26) discard;\n";
constexpr const char* kOpaqueCode =
    "//VTK::Color::Impl\n"
    "  vertexColorVSOutput.a = 1.0;\n";

std::uint8_t code_of(float diameter_m) {
  constexpr double kLogOfTwo = 0.6931471805599453;
  const double times = std::max(static_cast<double>(diameter_m), kLeastDiameter_m) / kLeastDiameter_m;
  const double doublings = gdtslam::log(times) / kLogOfTwo;
  return static_cast<std::uint8_t>(std::min(255.0, std::floor(doublings * kDiametersPerDoubling + 0.5)));
}

struct Uniforms {
  float scale_px = 1.0F;
  std::array<float, 2> range_px{1.0F, 1.0F};
};

struct Piece {
  vtkNew<vtkActor> actor;
  vtkNew<vtkCallbackCommand> on_shader;
  const Uniforms* uniforms = nullptr;
  std::size_t count = 0;
  std::size_t shown = 0;
  double first_s = 0.0;
  double span_s = 0.0;
  std::vector<std::uint32_t> ticks;  // of the points' stamps within the span; empty where all are one

  [[nodiscard]] double tick_of(double stamp_s) const {
    return std::floor((stamp_s - first_s) / span_s * static_cast<double>(std::numeric_limits<std::uint32_t>::max()));
  }
  [[nodiscard]] std::size_t count_until(double stamp_s) const {
    if (stamp_s < first_s) return 0;
    if (ticks.empty() || stamp_s >= first_s + span_s) return count;
    const auto tick = static_cast<std::uint32_t>(tick_of(stamp_s));
    return static_cast<std::size_t>(std::upper_bound(ticks.begin(), ticks.end(), tick) - ticks.begin());
  }
};

void set_uniforms(vtkObject* /*mapper*/, unsigned long /*event*/, void* piece_data, void* program_data) {
  const auto* piece = static_cast<const Piece*>(piece_data);
  auto* program = static_cast<vtkShaderProgram*>(program_data);
  if (program == nullptr || !program->IsUniformUsed("dots_shown")) return;
  program->SetUniformi("dots_shown", static_cast<int>(piece->shown));
  program->SetUniformf("dot_scale_px", piece->uniforms->scale_px);
  program->SetUniform2f("dot_range_px", piece->uniforms->range_px.data());
}

void let_shaders_size_points(vtkObject* /*renderer*/, unsigned long event, void* /*data*/, void* /*call*/) {
  if (event == vtkCommand::StartEvent) glEnable(GL_PROGRAM_POINT_SIZE);
  if (event == vtkCommand::EndEvent) glDisable(GL_PROGRAM_POINT_SIZE);
}

double stamp_for_order(const CloudPoint& point) {
  return std::isnan(point.stamp_s) ? -std::numeric_limits<double>::infinity() : point.stamp_s;
}

void sort_by_time(std::span<const CloudPoint> cloud, std::vector<std::uint32_t>& drawn) {
  const auto is_before = [&cloud](std::uint32_t a, std::uint32_t b) {
    return stamp_for_order(cloud[a]) < stamp_for_order(cloud[b]);
  };
  if (!std::is_sorted(drawn.begin(), drawn.end(), is_before)) std::stable_sort(drawn.begin(), drawn.end(), is_before);
}

void keep_times(Piece& piece, std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn) {
  piece.first_s = stamp_for_order(cloud[drawn.front()]);
  piece.span_s = stamp_for_order(cloud[drawn.back()]) - piece.first_s;
  if (!(piece.span_s > 0.0) || !std::isfinite(piece.span_s)) {
    piece.span_s = 0.0;  // without times, or endless: shown as a whole
    return;
  }
  piece.ticks.resize(drawn.size());
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    piece.ticks[k] = static_cast<std::uint32_t>(piece.tick_of(cloud[drawn[k]].stamp_s));
  }
}

vtkNew<vtkCellArray> one_cell_of(std::size_t count) {
  vtkNew<vtkCellArray> cells;
  cells->Use32BitStorage();
  cells->InsertNextCell(static_cast<int>(count));
  for (std::size_t k = 0; k < count; ++k) cells->InsertCellPoint(static_cast<vtkIdType>(k));
  return cells;
}

vtkNew<vtkPolyData> data_of(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn,
                            const CloudPoints::DotOf& dot_of) {
  const auto count = static_cast<vtkIdType>(drawn.size());
  vtkNew<vtkFloatArray> places;
  places->SetNumberOfComponents(3);
  places->SetNumberOfTuples(count);
  vtkNew<vtkUnsignedCharArray> colours;
  colours->SetNumberOfComponents(4);
  colours->SetNumberOfTuples(count);
  float* place = places->GetPointer(0);
  unsigned char* colour = colours->GetPointer(0);
  for (const std::uint32_t index : drawn) {
    const CloudPoint& point = cloud[index];
    const CloudPoints::Dot dot = dot_of(index);
    for (const float coordinate : {point.x_m, point.y_m, point.z_m}) *place++ = coordinate;
    for (const std::uint8_t channel : {dot.colour.red, dot.colour.green, dot.colour.blue, code_of(dot.diameter_m)}) {
      *colour++ = channel;
    }
  }
  vtkNew<vtkPoints> points;
  points->SetData(places);
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->GetPointData()->SetScalars(colours);
  return data;
}

}  // namespace

struct CloudPoints::State {
  explicit State(vtkRenderer& to) : renderer(to) {}
  vtkRenderer& renderer;
  vtkNew<vtkCallbackCommand> on_render;
  Uniforms uniforms;
  std::vector<std::unique_ptr<Piece>> pieces;  // their places are known to callbacks

  void add(std::unique_ptr<Piece> piece, vtkPolyData& data) {
    vtkNew<vtkOpenGLPolyDataMapper> mapper;
    mapper->SetInputData(&data);
    mapper->SetColorModeToDirectScalars();
    mapper->StaticOn();
    piece->uniforms = &uniforms;
    piece->on_shader->SetCallback(set_uniforms);
    piece->on_shader->SetClientData(piece.get());
    mapper->AddObserver(vtkCommand::UpdateShaderEvent, piece->on_shader);
    piece->actor->SetMapper(mapper);
    piece->actor->ForceOpaqueOn();
    piece->actor->GetProperty()->LightingOff();
    vtkShaderProperty* shaders = piece->actor->GetShaderProperty();
    shaders->AddVertexShaderReplacement("//VTK::PositionVC::Dec", true, kSizeDeclaration, false);
    shaders->AddVertexShaderReplacement("//VTK::PositionVC::Impl", true, kSizeCode, false);
    shaders->AddVertexShaderReplacement("//VTK::Color::Impl", true, kOpaqueCode, false);
    shaders->AddFragmentShaderReplacement("//VTK::Color::Impl", true, kRoundCode, false);
    renderer.AddActor(piece->actor);
    pieces.push_back(std::move(piece));
  }
};

CloudPoints::CloudPoints(vtkRenderer& renderer) : state_(std::make_unique<State>(renderer)) {
  state_->on_render->SetCallback(let_shaders_size_points);
  renderer.AddObserver(vtkCommand::StartEvent, state_->on_render);
  renderer.AddObserver(vtkCommand::EndEvent, state_->on_render);
}

CloudPoints::~CloudPoints() = default;

void CloudPoints::set(std::span<const CloudPoint> cloud, std::vector<std::uint32_t> drawn, const DotOf& dot_of) {
  sort_by_time(cloud, drawn);
  vtkNew<vtkCellArray> whole = one_cell_of(kPiece);  // one for all pieces of full length
  const std::span<const std::uint32_t> all(drawn);
  for (std::size_t begin = 0; begin < all.size(); begin += kPiece) {
    const auto part = all.subspan(begin, std::min(kPiece, all.size() - begin));
    auto piece = std::make_unique<Piece>();
    piece->count = part.size();
    piece->shown = part.size();
    keep_times(*piece, cloud, part);
    vtkNew<vtkPolyData> data = data_of(cloud, part, dot_of);
    if (part.size() == kPiece) {
      data->SetVerts(whole);
    } else {
      data->SetVerts(one_cell_of(part.size()));
    }
    state_->add(std::move(piece), *data);
  }
}

void CloudPoints::show_until(double stamp_s) {
  for (const auto& piece : state_->pieces) {
    piece->shown = piece->count_until(stamp_s);
    piece->actor->SetVisibility(piece->shown > 0);
  }
}

void CloudPoints::set_sizes(const PointSizes& sizes, const Camera& camera, const PictureSize& size) {
  Uniforms& uniforms = state_->uniforms;
  const double samples = sizes.samples;
  const double visible_m = camera.is_parallel ? camera.parallel_height_m : 2.0 * half_height_slope(camera);
  uniforms.scale_px = static_cast<float>(samples * size.height / visible_m);
  const bool is_fixed = sizes.fixed_px > 0.0;
  uniforms.range_px = {static_cast<float>(samples * (is_fixed ? sizes.fixed_px : sizes.least_px)),
                       static_cast<float>(samples * (is_fixed ? sizes.fixed_px : sizes.largest_px))};
}

std::uint64_t CloudPoints::shown() const {
  std::uint64_t count = 0;
  for (const auto& piece : state_->pieces) count += piece->shown;
  return count;
}

}  // namespace gdtslam
