// Meshes from memory: the same tetrahedron in every format, placed, and bytes that are none.
#include "gdtslam/sim/mesh_import.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <string>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

TriangleMesh import_text(const std::string& text, const std::string& name, const MeshPlacement& placement = {}) {
  return import_mesh(std::as_bytes(std::span(text)), name, placement);
}

double volume_of(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    volume += a.dot(b.cross(c)) / 6.0;
  }
  return volume;
}

// A box of 1 x 2 x 3 with quadrilateral faces.
const std::string kObj =
    "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 0 2 0\nv 0 0 3\nv 1 0 3\nv 1 2 3\nv 0 2 3\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

// A tetrahedron of volume 1/6.
const std::string kStl =
    "solid t\n"
    "facet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n"
    "facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n"
    "facet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\n"
    "facet normal 1 1 1\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n"
    "endsolid t\n";

std::string binary_stl() {
  const float corners[4][9] = {{0, 0, 0, 0, 1, 0, 1, 0, 0},
                               {0, 0, 0, 1, 0, 0, 0, 0, 1},
                               {0, 0, 0, 0, 0, 1, 0, 1, 0},
                               {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  std::string bytes(80, '\0');
  const std::uint32_t count = 4;
  bytes.append(reinterpret_cast<const char*>(&count), sizeof(count));
  for (const auto& triangle : corners) {
    bytes.append(12, '\0');
    bytes.append(reinterpret_cast<const char*>(triangle), sizeof(triangle));
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST(MeshImport, ReadsObjAndStl) {
  const TriangleMesh box = import_text(kObj, "box.obj");
  EXPECT_EQ(box.triangles.size(), 12U);
  EXPECT_NEAR(volume_of(box), 6.0, 1e-6);
  EXPECT_NEAR(volume_of(import_text(kStl, "t.STL")), 1.0 / 6.0, 1e-6);
  EXPECT_NEAR(volume_of(import_text(binary_stl(), "t.stl")), 1.0 / 6.0, 1e-6);
}

TEST(MeshImport, PlacesTheMesh) {
  MeshPlacement placement;
  placement.scale = 0.01;
  placement.yaw_rad = rad_from_deg(90.0);
  placement.position_m = {5.0, 6.0, 0.5};
  const TriangleMesh box = import_text(kObj, "box.obj", placement);
  Vec3 low = box.vertices.front();
  Vec3 high = low;
  for (const Vec3& v : box.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  // 1 along x turns to y, 2 along y turns to -x.
  EXPECT_NEAR((low - Vec3(4.98, 6.0, 0.5)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((high - Vec3(5.0, 6.01, 0.53)).norm(), 0.0, 1e-6);
}

TEST(MeshImport, StandsUpWhatHasItsYUp) {
  const TriangleMesh box = import_text(kObj, "box.obj", {.y_is_up = true});
  double top = -1e9;
  for (const Vec3& v : box.vertices) {
    top = std::max(top, v.z());
  }
  EXPECT_NEAR(top, 2.0, 1e-6);
  EXPECT_NEAR(volume_of(box), 6.0, 1e-6);
}

TEST(MeshImport, SaysWhatIsWrong) {
  const auto message_of = [](const std::string& text, const std::string& name) -> std::string {
    try {
      import_text(text, name);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message_of(kObj, "box.gltf").find("box.gltf: not a mesh that can be imported"), std::string::npos);
  EXPECT_NE(message_of(kObj, "noext"), "");
  EXPECT_NE(message_of("", "empty.obj"), "");
  EXPECT_NE(message_of("hello\nworld\n", "text.obj"), "");
  EXPECT_NE(message_of("v 0 0 0\nv 1 0 0\n", "points.obj"), "");
  EXPECT_NE(message_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "faces.obj"), "");
  EXPECT_NE(message_of(binary_stl().substr(0, 150), "cut.stl"), "");
  for (const std::string& message : {message_of("hello\n", "a.obj"), message_of("solid\n", "a.stl")}) {
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace gdtslam::sim
