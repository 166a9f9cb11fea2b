#include <charconv>
#include <system_error>

#include "engine/io/clouds/cloud_words.hpp"
#include "mesh_builder.hpp"

namespace gdtslam {
namespace {

// A line goes on in the next one where it ends in a backslash.
bool next_line(CloudInput& input, std::string& line) {
  std::optional<std::string_view> piece = input.line();
  if (!piece) return false;
  line = *piece;
  while (line.ends_with('\\') && (piece = input.line())) {
    line.pop_back();
    line += *piece;
    if (line.size() > CloudInput::kMostLineBytes) {
      throw InputError({input.name(), input.line_number()}, "the line is longer than 64 KiB with those before it");
    }
  }
  return true;
}

// "v x y z", then a weight, which only curved surfaces need, or a colour.
std::array<float, 3> vertex_of(std::string_view numbers, const MeshBuilder& mesh) {
  CloudNumbers row(numbers);
  const std::array<float, 3> vertex = next_vertex(row, mesh, "expected 'v X Y Z'");
  const std::optional<double> weight = row.next(Scalar::kDouble);
  if (weight && *weight != 1.0 && row.at_end()) mesh.fail("a vertex with a weight other than 1 is not read");
  return vertex;
}

// "7", "7/2", "7//3" or "7/2/3": the first number is the vertex, from 1, or from the last one back when negative.
std::uint32_t corner_of(std::string_view word, const MeshBuilder& mesh) {
  const std::string_view digits = word.substr(0, word.find('/'));
  std::int64_t index = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  if (error != std::errc{} || end != digits.data() + digits.size()) {
    mesh.fail("expected 'f' and the numbers of its vertices");
  }
  const auto count = static_cast<std::int64_t>(mesh.vertex_count());
  if (index == 0 || index > count || index < -count) {
    mesh.fail("a face names a vertex that is not there yet: export the mesh again");
  }
  return static_cast<std::uint32_t>(index > 0 ? index - 1 : count + index);
}

}  // namespace

void read_obj(CloudInput& input, MeshBuilder& mesh) {
  std::string line;
  std::vector<std::uint32_t> corners;
  while (next_line(input, line)) {
    mesh.begin_line(input.line_number());
    const std::string_view text = std::string_view(line).substr(0, line.find('#'));
    const std::size_t begin = text.find_first_not_of(" \t");
    const std::string_view word = begin == std::string_view::npos
                                      ? std::string_view()
                                      : text.substr(begin, text.find_first_of(" \t", begin) - begin);
    if (word == "v") {
      mesh.add_vertex(vertex_of(text.substr(begin + 1), mesh));
    } else if (word == "f") {
      corners.clear();
      for (const std::string_view corner : words_of(text.substr(begin + 1))) {
        corners.push_back(corner_of(corner, mesh));
      }
      mesh.add_face(corners);
    }
  }
}

}  // namespace gdtslam
