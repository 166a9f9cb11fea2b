#include "mesh_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gdtslam {
namespace {

using Corner = std::array<double, 2>;

// Twice the area of a triangle, positive if it is counter-clockwise.
double doubled_area(const Corner& a, const Corner& b, const Corner& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// The corners seen along the axis that is closest to the polygon's normal (Newell's sum), counter-clockwise.
std::vector<Corner> flattened(std::span<const std::uint32_t> corners,
                              const std::vector<std::array<float, 3>>& vertices) {
  std::array<double, 3> normal{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::array<float, 3>& a = vertices[corners[i]];
    const std::array<float, 3>& b = vertices[corners[(i + 1) % corners.size()]];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t u = (axis + 1) % 3;
      const std::size_t v = (axis + 2) % 3;
      normal[axis] += (double{a[u]} - double{b[u]}) * (double{a[v]} + double{b[v]});
    }
  }
  const auto largest =
      std::max_element(normal.begin(), normal.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  const auto axis = static_cast<std::size_t>(largest - normal.begin());
  const double sign = *largest < 0.0 ? -1.0 : 1.0;
  std::vector<Corner> flat;
  for (const std::uint32_t corner : corners) {
    flat.push_back({double{vertices[corner][(axis + 1) % 3]}, sign * double{vertices[corner][(axis + 2) % 3]}});
  }
  return flat;
}

bool is_convex(const std::vector<Corner>& flat) {
  for (std::size_t i = 0; i < flat.size(); ++i) {
    if (doubled_area(flat[i], flat[(i + 1) % flat.size()], flat[(i + 2) % flat.size()]) < 0.0) return false;
  }
  return true;
}

}  // namespace

void MeshBuilder::begin_row(const char* kind, std::uint64_t number) {
  constexpr std::uint64_t kRowsBetweenQuestions = 4096;
  kind_ = kind;
  number_ = number;
  if (++rows_ % kRowsBetweenQuestions == 0 && options_.stop && options_.stop()) {
    throw Error(ExitCode::kInterrupted, "interrupted while a mesh was read; nothing is written");
  }
}

void MeshBuilder::fail(const std::string& message) const {
  if (kind_ == nullptr) throw InputError({name_, number_}, message);
  throw InputError({name_, 0}, fmt::format("{} {}: {}", kind_, number_, message));
}

void MeshBuilder::add_vertex(const std::array<float, 3>& vertex) {
  if (!std::all_of(vertex.begin(), vertex.end(), [](float number) { return std::isfinite(number); })) {
    fail("a vertex needs three finite numbers");
  }
  if (mesh_.vertices.size() >= 3 * options_.max_triangles) {
    fail(fmt::format("has more than {} vertices: simplify the mesh", 3 * options_.max_triangles));
  }
  mesh_.vertices.push_back(vertex);
}

void MeshBuilder::add_triangle(const std::array<std::uint32_t, 3>& triangle) {
  if (mesh_.triangles.size() >= options_.max_triangles) {
    fail(fmt::format("has more than {} triangles: simplify the mesh", options_.max_triangles));
  }
  mesh_.triangles.push_back(triangle);
}

void MeshBuilder::add_face(std::span<const std::uint32_t> corners) {
  if (corners.size() > kMostCorners) {
    fail(fmt::format("a face has more than {} corners: export the mesh as triangles", kMostCorners));
  }
  for (const std::uint32_t corner : corners) {
    if (corner >= mesh_.vertices.size()) {
      fail("a face names a vertex that the mesh does not have: export the mesh again");
    }
  }
  if (corners.size() < 3) return;
  if (corners.size() > 3 && !is_convex(flattened(corners, mesh_.vertices))) {
    fail("a face is not convex: export the mesh as triangles");
  }
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) add_triangle({corners[0], corners[i], corners[i + 1]});
}

MeshFile MeshBuilder::finish() {
  if (mesh_.triangles.empty()) throw InputError({name_, 0}, "holds no triangle: export it with its faces");
  constexpr auto kUnused = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> new_index(mesh_.vertices.size(), kUnused);
  for (const std::array<std::uint32_t, 3>& triangle : mesh_.triangles) {
    for (const std::uint32_t corner : triangle) new_index[corner] = 0;
  }
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < new_index.size(); ++i) {
    if (new_index[i] == kUnused) continue;
    mesh_.vertices[kept] = mesh_.vertices[i];
    new_index[i] = kept++;
  }
  mesh_.vertices.resize(kept);
  for (std::array<std::uint32_t, 3>& triangle : mesh_.triangles) {
    for (std::uint32_t& corner : triangle) corner = new_index[corner];
  }
  return std::move(mesh_);
}

}  // namespace gdtslam
