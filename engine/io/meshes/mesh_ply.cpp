#include <utility>

#include "engine/io/clouds/cloud_words.hpp"
#include "mesh_builder.hpp"

namespace gdtslam {
namespace {

/// Reads the values of elements in order, from words of a line or from bytes.
class PlyMeshReader {
 public:
  PlyMeshReader(CloudInput& input, MeshBuilder& mesh, const PlyHeader& header)
      : input_(input), mesh_(mesh), row_(input, header.is_ascii, header.is_big_endian) {}

  void read(const CloudElement& element) {
    if (element.columns.empty()) return;  // takes no bytes, for any number of them
    if (element.is_face) check_face(element);
    for (std::uint64_t k = 0; k < element.count; ++k) {
      begin_row(element, k);
      if (row_.is_ascii() && !element.is_vertex && !element.is_face) continue;
      read_row(element);
      if (element.is_vertex) mesh_.add_vertex(vertex_);
      if (element.is_face) mesh_.add_face(corners_);
    }
  }

 private:
  void check_face(const CloudElement& element) const {
    for (const CloudColumn& column : element.columns) {
      if (column.is_corner_list) return;
    }
    throw InputError({input_.name(), 0}, "its faces have no list 'vertex_indices': export the mesh again");
  }

  void begin_row(const CloudElement& element, std::uint64_t k) {
    corners_.clear();
    const bool is_there = row_.begin_row();
    if (row_.is_ascii()) {
      mesh_.begin_line(input_.line_number());
    } else {
      mesh_.begin_row(element.is_vertex ? "vertex" : element.is_face ? "face" : "element", k);
    }
    if (!is_there) ends_early();
  }

  void read_row(const CloudElement& element) {
    const std::string_view fault = row_.read(element, [&](const CloudColumn& column, double number) {
      const auto axis = static_cast<std::size_t>(column.role);
      if (column.is_corner_list) add_corner(number);
      if (!column.list_count && element.is_vertex && axis < vertex_.size()) vertex_[axis] = static_cast<float>(number);
    });
    if (fault == RowValues::kEndsEarly) ends_early();
    if (!fault.empty()) mesh_.fail(std::string(fault));
  }

  void add_corner(double number) {
    if (!(number >= 0.0 && number < static_cast<double>(mesh_.vertex_count())) ||
        number != static_cast<double>(static_cast<std::uint32_t>(number))) {
      mesh_.fail("a face names a vertex that the mesh does not have: export the mesh again");
    }
    if (corners_.size() <= MeshBuilder::kMostCorners) corners_.push_back(static_cast<std::uint32_t>(number));
  }

  [[noreturn]] void ends_early() const { mesh_.fail("the file ends before all that its header names; is it whole?"); }

  CloudInput& input_;
  MeshBuilder& mesh_;
  RowValues row_;
  std::array<float, 3> vertex_{};
  std::vector<std::uint32_t> corners_;
};

void check_vertex(const CloudElement& element, const std::string& name) {
  for (const CloudRole axis : {CloudRole::kX, CloudRole::kY, CloudRole::kZ}) {
    int times = 0;
    for (const CloudColumn& column : element.columns) times += column.role == axis && !column.list_count ? 1 : 0;
    if (times != 1) throw InputError({name, 0}, "its vertices need one property x, one y and one z");
  }
}

}  // namespace

void read_ply_mesh(CloudInput& input, MeshBuilder& mesh) {
  const std::optional<std::string_view> first = input.line();
  if (first != "ply") throw InputError({input.name(), 1}, "is no PLY: the first line does not say 'ply'");
  const PlyHeader header = read_ply_elements(input);
  PlyMeshReader reader(input, mesh, header);
  bool has_vertices = false;
  for (const CloudElement& element : header.elements) {
    if (element.is_vertex) {
      check_vertex(element, input.name());
      has_vertices = true;
    }
    if (element.is_face && !has_vertices) {
      throw InputError({input.name(), 0}, "its faces stand before its vertices: export the mesh again");
    }
    reader.read(element);
  }
}

}  // namespace gdtslam
