#include "cloud_points_prop.hpp"

#include <GL/glew.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOpenGLCamera.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLShaderCache.h>
#include <vtkRenderer.h>
#include <vtkShaderProgram.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

constexpr float kKeptRadius = 0.4F;  // of half the picture's height: of the cone that is kept clear
constexpr double kLeastDiameter_m = 0.001;
constexpr double kCodesPerDoubling = 20.0;
// OpenGL on the processor keeps what is waiting to be drawn, some 100 bytes a point, without end.
constexpr std::size_t kMostUnderWay = 1U << 20U;

// The size of a point is that of a disc in space: w is its depth before a perspective camera, and 1 before a parallel
// one. The words after // are VTK's, which puts the version and the names of the outputs there.
constexpr const char* kVertexCode =
    "//VTK::System::Dec\n"
    "in vec3 place;\n"
    "in vec4 colour_and_size;\n"
    "uniform mat4 clip_from_place;\n"
    "uniform float metre_px;\n"
    "uniform vec2 range_px;\n"
    "uniform vec3 kept_place;\n"
    "uniform float kept_radius;\n"
    "uniform float kept_aspect;\n"
    "out vec3 dot_colour;\n"
    "void main() {\n"
    "  gl_Position = clip_from_place * vec4(place, 1.0);\n"
    "  vec4 kept = clip_from_place * vec4(kept_place, 1.0);\n"
    "  vec2 off = (gl_Position.xy / gl_Position.w - kept.xy / kept.w) * vec2(kept_aspect, 1.0);\n"
    "  bool is_before = kept.w - gl_Position.w > 0.4 && place.z > kept_place.z;\n"
    "  if (is_before && length(off) < kept_radius) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);\n"
    "  float diameter_m = 0.001 * exp2(colour_and_size.a * (255.0 / 20.0));\n"
    "  gl_PointSize = clamp(metre_px * diameter_m / gl_Position.w, range_px.x, range_px.y);\n"
    "  dot_colour = colour_and_size.rgb;\n"
    "}\n";
constexpr const char* kFragmentCode =
    "//VTK::System::Dec\n"
    "//VTK::Output::Dec\n"
    "in vec3 dot_colour;\n"
    "void main() {\n"
    "  vec2 from_centre = gl_PointCoord - vec2(0.5);\n"
    "  if (dot(from_centre, from_centre) > 0.26) discard;\n"
    "  gl_FragData[0] = vec4(dot_colour, 1.0);\n"
    "}\n";

// VTK keeps the transposes of the matrices, as OpenGL wants them.
vtkNew<vtkMatrix4x4> clip_from_place(vtkRenderer& renderer, const Point3& origin) {
  vtkMatrix4x4* view_from_map = nullptr;
  vtkMatrix3x3* normals = nullptr;
  vtkMatrix4x4* clip_from_view = nullptr;
  vtkMatrix4x4* clip_from_map = nullptr;
  auto* camera = vtkOpenGLCamera::SafeDownCast(renderer.GetActiveCamera());
  camera->GetKeyMatrices(&renderer, view_from_map, normals, clip_from_view, clip_from_map);
  vtkNew<vtkMatrix4x4> map_from_place;
  for (int axis = 0; axis < 3; ++axis) map_from_place->SetElement(3, axis, origin[axis]);
  vtkNew<vtkMatrix4x4> result;
  vtkMatrix4x4::Multiply4x4(map_from_place, clip_from_map, result);
  return result;
}

}  // namespace

std::uint8_t diameter_code(double diameter_m) {
  constexpr double kLogOfTwo = 0.6931471805599453;
  const double doublings = gdtslam::log(std::max(diameter_m, kLeastDiameter_m) / kLeastDiameter_m) / kLogOfTwo;
  return static_cast<std::uint8_t>(std::min(255.0, std::floor(doublings * kCodesPerDoubling + 0.5)));
}

vtkStandardNewMacro(CloudPointsProp);

void CloudPointsProp::add_piece(std::vector<DotVertex> dots) {
  for (const DotVertex& dot : dots) {
    bounds_.add(origin_ + Point3(static_cast<double>(dot.place[0]), static_cast<double>(dot.place[1]),
                                 static_cast<double>(dot.place[2])));
  }
  Piece piece;
  piece.shown = dots.size();
  piece.waiting = std::move(dots);
  pieces_.push_back(std::move(piece));
}

void CloudPointsProp::set_sizes(double metre_px, double least_px, double largest_px) {
  metre_px_ = static_cast<float>(metre_px);
  range_px_ = {static_cast<float>(least_px), static_cast<float>(largest_px)};
}

double* CloudPointsProp::GetBounds() {
  if (bounds_.is_empty()) return nullptr;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    vtk_bounds_[2 * axis] = bounds_.lowest[static_cast<Eigen::Index>(axis)];
    vtk_bounds_[2 * axis + 1] = bounds_.highest[static_cast<Eigen::Index>(axis)];
  }
  return vtk_bounds_.data();
}

// Sends the piece to OpenGL when that has not been done, and frees it here.
void CloudPointsProp::bind(Piece& piece, std::int32_t place_at, std::int32_t colour_at) {
  if (piece.buffer == 0) glGenBuffers(1, &piece.buffer);
  glBindBuffer(GL_ARRAY_BUFFER, piece.buffer);
  if (!piece.waiting.empty()) {
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(piece.waiting.size() * sizeof(DotVertex)),
                 piece.waiting.data(), GL_STATIC_DRAW);
    std::vector<DotVertex>().swap(piece.waiting);
  }
  // OpenGL takes an offset into the buffer as a pointer.
  const auto offset = [](std::size_t bytes) {
    return reinterpret_cast<const void*>(bytes);  // NOLINT(performance-no-int-to-ptr)
  };
  constexpr GLsizei kStride = sizeof(DotVertex);
  glVertexAttribPointer(static_cast<GLuint>(place_at), 3, GL_FLOAT, GL_FALSE, kStride,
                        offset(offsetof(DotVertex, place)));
  glVertexAttribPointer(static_cast<GLuint>(colour_at), 4, GL_UNSIGNED_BYTE, GL_TRUE, kStride,
                        offset(offsetof(DotVertex, colour)));
}

int CloudPointsProp::RenderOpaqueGeometry(vtkViewport* viewport) {
  auto* renderer = vtkRenderer::SafeDownCast(viewport);
  auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
  vtkShaderProgram* program = window->GetShaderCache()->ReadyShaderProgram(kVertexCode, kFragmentCode, "");
  if (program == nullptr) return 0;  // the view throws what VTK has said
  program->SetUniformMatrix("clip_from_place", clip_from_place(*renderer, origin_));
  program->SetUniformf("metre_px", metre_px_);
  program->SetUniform2f("range_px", range_px_.data());
  const Eigen::Vector3f kept = (kept_in_view_.value_or(origin_) - origin_).cast<float>();
  const int* size = window->GetSize();
  program->SetUniform3f("kept_place", kept.data());
  program->SetUniformf("kept_radius", kept_in_view_ ? kKeptRadius : 0.0F);
  program->SetUniformf("kept_aspect", static_cast<float>(size[0]) / static_cast<float>(std::max(1, size[1])));
  const auto handle = static_cast<GLuint>(program->GetHandle());
  const GLint place_at = glGetAttribLocation(handle, "place");
  const GLint colour_at = glGetAttribLocation(handle, "colour_and_size");
  if (layout_ == 0) glGenVertexArrays(1, &layout_);
  glBindVertexArray(layout_);
  glEnableVertexAttribArray(static_cast<GLuint>(place_at));
  glEnableVertexAttribArray(static_cast<GLuint>(colour_at));
  glEnable(GL_PROGRAM_POINT_SIZE);
  std::size_t under_way = 0;
  for (Piece& piece : pieces_) {
    if (piece.shown == 0) continue;
    bind(piece, place_at, colour_at);
    glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(piece.shown));
    under_way += piece.shown;
    if (under_way < kMostUnderWay) continue;
    glFinish();
    under_way = 0;
  }
  glDisable(GL_PROGRAM_POINT_SIZE);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
  glBindVertexArray(0);
  return 1;
}

void CloudPointsProp::ReleaseGraphicsResources(vtkWindow* /*window*/) {
  for (Piece& piece : pieces_) {
    if (piece.buffer != 0) glDeleteBuffers(1, &piece.buffer);
    piece.buffer = 0;
  }
  if (layout_ != 0) glDeleteVertexArrays(1, &layout_);
  layout_ = 0;
}

}  // namespace gdtslam
