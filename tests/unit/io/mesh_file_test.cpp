// Meshes: the same solids in every format, polygons, and one clear line for bytes that are none.
#include "engine/io/meshes/mesh_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

using Triangle = std::array<std::uint32_t, 3>;

MeshFile mesh_of(const std::string& text, const std::string& name, const MeshReadOptions& options = {}) {
  return read_mesh(std::as_bytes(std::span(text)), name, options);
}

std::string refusal(const std::string& text, const std::string& name, const MeshReadOptions& options = {}) {
  try {
    mesh_of(text, name, options);
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find(name), 0U) << error.what();
    return std::string(error.what()).substr(name.size());
  }
  return "accepted";
}

// By the divergence theorem; right only for a closed surface whose triangles all run the same way round.
double volume_of(const MeshFile& mesh) {
  double volume = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const auto& [a, b, c] = std::array{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    volume += double{a[0]} * (double{b[1]} * double{c[2]} - double{b[2]} * double{c[1]}) +
              double{a[1]} * (double{b[2]} * double{c[0]} - double{b[0]} * double{c[2]}) +
              double{a[2]} * (double{b[0]} * double{c[1]} - double{b[1]} * double{c[0]});
  }
  return volume / 6.0;
}

template <class T>
void append(std::string& bytes, T value, bool is_big_endian = false) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  if (is_big_endian) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

/// Rows of vertices and faces, a line each, as an ASCII file.
std::string ply_of(const std::vector<std::string>& vertices, const std::vector<std::string>& faces) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string(faces.size()) + "\nproperty list ushort int vertex_indices\nend_header\n";
  for (const std::vector<std::string>* const rows : {&vertices, &faces}) {
    for (const std::string& row : *rows) text += row + "\n";
  }
  return text;
}

// A box of 1 x 2 x 3 with quadrilateral faces.
const std::string kBox = ply_of({"0 0 0", "1 0 0", "1 2 0", "0 2 0", "0 0 3", "1 0 3", "1 2 3", "0 2 3"},
                                {"4 3 2 1 0", "4 4 5 6 7", "4 0 1 5 4", "4 1 2 6 5", "4 2 3 7 6", "4 3 0 4 7"});

// A tetrahedron of volume 1/6.
const std::string kStl =
    "solid t\n"
    "facet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n"
    "facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n"
    "FACET NORMAL -1 0 0\n  OUTER LOOP\n\tVERTEX 0 0 0\r\n vertex 0 0 1e0\nvertex 0 +1.0 0\nendloop\nendfacet\n"
    "facet normal 1 1 1\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n"
    "endsolid t\n";

std::string binary_stl(std::uint32_t count = 4) {
  constexpr std::array<std::array<float, 9>, 4> kCorners{{{0, 0, 0, 0, 1, 0, 1, 0, 0},
                                                          {0, 0, 0, 1, 0, 0, 0, 0, 1},
                                                          {0, 0, 0, 0, 0, 1, 0, 1, 0},
                                                          {1, 0, 0, 0, 1, 0, 0, 0, 1}}};
  std::string bytes = "solid, which some programs write into binary files too";
  bytes.resize(80, '\0');
  append(bytes, count);
  for (const std::array<float, 9>& triangle : kCorners) {
    bytes.append(12, '\0');
    for (const float number : triangle) append(bytes, number);
    bytes.append(2, '\0');
  }
  return bytes;
}

const std::string kPly =
    "ply\nformat ascii 1.0\ncomment a tetrahedron\nelement vertex 4\nproperty float x\nproperty uchar red\n"
    "property float y\nproperty double z\nelement material 1\nproperty int shine\nelement face 4\n"
    "property uchar flag\nproperty list uchar int vertex_indices\nend_header\n"
    "0 9 0 0\n1 9 0 0\n0 9 1 0\n\n0 9 0 1\n77\n"
    "0 3 0 2 1\n0 3 0 1 3\n0 3 0 3 2\n0 3 1 2 3\n";

std::string binary_ply(bool is_big_endian) {
  std::string bytes = std::string("ply\nformat binary_") + (is_big_endian ? "big" : "little") +
                      "_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\n"
                      "element face 4\nproperty list ushort uint vertex_index\nend_header\n";
  for (const std::array<float, 3>& v : {std::array{0.0F, 0.0F, 0.0F}, std::array{1.0F, 0.0F, 0.0F},
                                        std::array{0.0F, 1.0F, 0.0F}, std::array{0.0F, 0.0F, 1.0F}}) {
    append(bytes, v[0], is_big_endian);
    append(bytes, v[1], is_big_endian);
    append(bytes, double{v[2]}, is_big_endian);
  }
  for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{0, 3, 2}, Triangle{1, 2, 3}}) {
    append(bytes, std::uint16_t{3}, is_big_endian);
    for (const std::uint32_t corner : t) append(bytes, corner, is_big_endian);
  }
  return bytes;
}

TEST(MeshFile, ReadsTheSameSolidInEveryFormat) {
  const MeshFile box = mesh_of(kBox, "box.ply");
  EXPECT_EQ(box.triangles.size(), 12U);
  EXPECT_NEAR(volume_of(box), 6.0, 1e-12);
  for (const auto& [text, name] : {std::pair{kStl, "t.STL"}, std::pair{binary_stl(), "t.stl"}, std::pair{kPly, "t.ply"},
                                   std::pair{binary_ply(false), "t.ply"}, std::pair{binary_ply(true), "t.PLY"}}) {
    const MeshFile mesh = mesh_of(text, name);
    EXPECT_EQ(mesh.triangles.size(), 4U) << name;
    EXPECT_NEAR(volume_of(mesh), 1.0 / 6.0, 1e-12) << name;
  }
}

TEST(MeshFile, TrianglesStandInTheOrderOfTheFile) {
  EXPECT_THAT(mesh_of(kPly, "t.ply").triangles,
              ElementsAre(Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{0, 3, 2}, Triangle{1, 2, 3}));
  EXPECT_THAT(
      mesh_of(ply_of({"0 0 0", "1 0 0", "1 1 0", "0 1 0", "9 9 9"}, {"4 0 1 2 3", "3 3 2 1"}), "q.ply").triangles,
      ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{3, 2, 1}));
}

TEST(MeshFile, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(refusal(kBox, "box.obj"), ": is not a mesh that can be read: export it as .ply or .stl");
  for (const char* name : {"empty.ply", "empty.stl"}) EXPECT_NE(refusal("", name), "accepted");
  // The header of ply_of() has 9 lines.
  EXPECT_THAT(refusal(ply_of({"0 0 0", "1 0 0"}, {}), "a.ply"), HasSubstr("holds no triangle"));
  EXPECT_THAT(refusal(ply_of({"0 0"}, {}), "a.ply"), StartsWith(":10: has fewer numbers than columns"));
  EXPECT_THAT(refusal(ply_of({"0 0 1e99"}, {}), "a.ply"), StartsWith(":10: a vertex needs three finite numbers"));
  for (const char* corner : {"3", "-1", "9999999999"}) {
    const std::string text = ply_of({"0 0 0", "1 0 0", "0 1 0"}, {std::string("3 0 1 ") + corner});
    EXPECT_THAT(refusal(text, "a.ply"), StartsWith(":13: ")) << corner;
  }
  std::string many = "257";
  for (int i = 0; i < 257; ++i) many += " 0";
  EXPECT_THAT(refusal(ply_of({"0 0 0"}, {many}), "a.ply"), StartsWith(":11: a face has more than 256 corners"));
  EXPECT_THAT(refusal(std::string(70'000, 'v'), "a.ply"), StartsWith(":1: the line is longer"));

  EXPECT_THAT(refusal("solid\nvertex 0 0\n", "a.stl"), StartsWith(":2: expected 'vertex X Y Z'"));
  EXPECT_THAT(refusal("solid\nvertex 0 0 0\nendfacet\n", "a.stl"), StartsWith(":3: the facet has fewer"));
  EXPECT_THAT(refusal("solid\nhello\n", "a.stl"), StartsWith(":2: \"hello\" is no keyword of STL"));
  EXPECT_NE(refusal(binary_stl().substr(0, 150), "cut.stl"), "accepted");
  EXPECT_NE(refusal(binary_stl(0xFFFFFFFFU), "count.stl"), "accepted");
}

TEST(MeshFile, BelievesNoNumberOfAPlyHeader) {
  const std::string format = "ply\nformat binary_little_endian 1.0\n";
  const std::string vertices = "element vertex 3\nproperty uchar x\nproperty uchar y\nproperty uchar z\n";
  const std::string points("\0\0\0\1\0\0\0\1\0", 9);
  const std::string list = "property list uint uint vertex_indices\n";
  // Elements without properties take no byte, however many there are.
  EXPECT_THAT(refusal(format + "element face 4294967295\nend_header\n", "a.ply"), HasSubstr("before its vertices"));
  EXPECT_THAT(refusal(format + "element vertex 18446744073709551615\nend_header\n", "a.ply"), HasSubstr("property x"));
  EXPECT_THAT(refusal(format + vertices + "element face 4294967295\nend_header\n" + points, "a.ply"),
              HasSubstr("holds no triangle"));
  EXPECT_THAT(refusal(format + vertices + "element face 9\nproperty uchar a\nend_header\n" + points, "a.ply"),
              HasSubstr("no list 'vertex_indices'"));
  EXPECT_THAT(refusal(format +
                          "element vertex 4000000000\nproperty uchar x\nproperty uchar y\nproperty uchar z\n"
                          "end_header\n" +
                          points,
                      "a.ply"),
              StartsWith(": vertex 3: the file ends before"));
  const std::string faces = format + vertices + "element face 4000000000\n" + list + "end_header\n" + points;
  EXPECT_THAT(refusal(faces, "a.ply"), StartsWith(": face 0: the file ends before"));
  EXPECT_THAT(refusal(faces + "\xFF\xFF\xFF\xFF", "a.ply"), StartsWith(": face 0: the file ends before"));
  EXPECT_THAT(refusal(faces + std::string("\1\0\0\0\3\0\0\0", 8), "a.ply"),
              StartsWith(": face 0: a face names a vertex that the mesh does not have"));
  EXPECT_THAT(refusal(kPly.substr(0, kPly.size() - 10), "t.ply"), StartsWith(":23: the file ends before"));
}

TEST(MeshFile, IsBoundedAndCanBeStopped) {
  EXPECT_THAT(refusal(kBox, "a.ply", {.max_triangles = 11}), StartsWith(":23: has more than 11 triangles"));
  EXPECT_THAT(refusal(ply_of({"0 0 0", "0 0 0", "0 0 0", "0 0 0"}, {}), "a.ply", {.max_triangles = 1}),
              StartsWith(":13: has more than 3 vertices"));
  const std::string long_text = ply_of(std::vector<std::string>(10'000, "0 0 0"), {});
  try {
    mesh_of(long_text, "a.ply", {.stop = [] { return true; }});
    ADD_FAILURE() << "not stopped";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kInterrupted);
  }
}

}  // namespace
}  // namespace gdtslam
