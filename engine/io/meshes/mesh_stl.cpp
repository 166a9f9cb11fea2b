#include <fmt/format.h>

#include <array>

#include "engine/core/ascii.hpp"
#include "engine/io/clouds/cloud_words.hpp"
#include "engine/io/message_text.hpp"
#include "mesh_builder.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kHeaderBytes = 80;  // text; the number of triangles follows
constexpr std::size_t kTriangleBytes = 50;

// Each triangle has a normal, three corners, and two unused bytes.
void read_binary(CloudInput& input, std::uint64_t triangles, MeshBuilder& mesh) {
  input.bytes(kHeaderBytes + 4);
  for (std::uint64_t i = 0; i < triangles; ++i) {
    mesh.begin_row("triangle", i);
    const char* const data = input.bytes(kTriangleBytes);
    if (data == nullptr) mesh.fail("the file became shorter while it was read");
    const auto first = static_cast<std::uint32_t>(mesh.vertex_count());
    for (std::size_t corner = 1; corner <= 3; ++corner) {
      std::array<float, 3> vertex{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        vertex[axis] = static_cast<float>(decode(Scalar::kFloat, data + 4 * (3 * corner + axis), false));
      }
      mesh.add_vertex(vertex);
    }
    mesh.add_face(std::array{first, first + 1, first + 2});
  }
}

// The next three numbers of a line.
std::array<float, 3> next_vertex(CloudNumbers& row, const MeshBuilder& mesh) {
  std::array<float, 3> vertex{};
  for (float& coordinate : vertex) {
    const std::optional<double> number = row.next(Scalar::kFloat);
    if (!number) mesh.fail("expected 'vertex X Y Z'");
    coordinate = static_cast<float>(*number);
  }
  return vertex;
}

void read_text(CloudInput& input, MeshBuilder& mesh) {
  std::vector<std::uint32_t> corners;
  while (const std::optional<std::string_view> line = input.line()) {
    mesh.begin_line(input.line_number());
    const std::vector<std::string_view> words = split_words(*line);
    const std::string word = words.empty() ? "" : in_small_letters(words[0]);
    if (word == "vertex") {
      if (corners.size() == MeshBuilder::kMostCorners) mesh.fail("the facet has no 'endfacet'");
      corners.push_back(static_cast<std::uint32_t>(mesh.vertex_count()));
      CloudNumbers row(line->substr(line->find(words[0]) + words[0].size()));
      const std::array<float, 3> vertex = next_vertex(row, mesh);
      if (!row.at_end()) mesh.fail("expected 'vertex X Y Z'");
      mesh.add_vertex(vertex);
    } else if (word == "endfacet") {
      if (corners.size() < 3) mesh.fail("the facet has fewer than three vertices");
      mesh.add_face(corners);
      corners.clear();
    } else if (!(word.empty() || word == "solid" || word == "facet" || word == "outer" || word == "endloop" ||
                 word == "endsolid" || word == "color")) {
      mesh.fail(fmt::format("{} is no keyword of STL", in_quotes(words[0])));
    }
  }
  if (!corners.empty()) mesh.fail("ends within a facet; is the file whole?");
}

}  // namespace

// A text begins with "solid", but so do some binary files; the length distinguishes them.
void read_stl(CloudInput& input, std::uint64_t bytes, MeshBuilder& mesh) {
  const char* const header = input.peek(kHeaderBytes + 4);
  const std::uint64_t triangles =
      header == nullptr ? 0 : static_cast<std::uint64_t>(decode(Scalar::kUint32, header + kHeaderBytes, false));
  if (header != nullptr && bytes == kHeaderBytes + 4 + triangles * kTriangleBytes) {
    read_binary(input, triangles, mesh);
    return;
  }
  const char* const beginning = input.peek(5);
  if (beginning == nullptr || in_small_letters({beginning, 5}) != "solid") {
    throw InputError({input.name(), 0}, header == nullptr
                                            ? "is no STL: it neither begins with 'solid' nor has a header of 84 bytes"
                                            : fmt::format("is neither STL that begins with 'solid' nor as long as the "
                                                          "{} triangles that its header names; is the file whole?",
                                                          triangles));
  }
  read_text(input, mesh);
}

}  // namespace gdtslam
