// Common parts of the readers of meshes: bounds on vertices and triangles, faces of any number of corners, and
// stopping. One object belongs to one thread.
#pragma once

#include <span>

#include "engine/io/clouds/cloud_words.hpp"
#include "gdtslam/core/error.hpp"
#include "mesh_file.hpp"

namespace gdtslam {

class MeshBuilder {
 public:
  MeshBuilder(const MeshReadOptions& options, const std::string& name) : options_(options), name_(name) {}

  /// A face of more corners than this is refused.
  static constexpr std::size_t kMostCorners = 256;

  /// Sets the place of the next faults: a line of the file, or the kind of item in a binary file ("triangle") and its
  /// number from 0. Call for each row: throws if reading must stop.
  void begin_row(const char* kind, std::uint64_t number);
  void begin_line(std::uint64_t line) { begin_row(nullptr, line); }
  void add_vertex(const std::array<float, 3>& vertex);
  /// Adds the triangles of a convex polygon, none for fewer than three corners. Throws InputError for any other.
  void add_face(std::span<const std::uint32_t> corners);
  [[nodiscard]] std::size_t vertex_count() const { return mesh_.vertices.size(); }
  /// Throws InputError with the place of the row.
  [[noreturn]] void fail(const std::string& message) const;
  /// The mesh without unused vertices. Throws InputError if there is no triangle.
  MeshFile finish();

 private:
  void add_triangle(const std::array<std::uint32_t, 3>& triangle);

  const MeshReadOptions& options_;
  const std::string& name_;
  const char* kind_ = nullptr;
  std::uint64_t number_ = 0;
  MeshFile mesh_;
  std::uint64_t rows_ = 0;
};

/// Each reads to the end of the input.
void read_ply_mesh(CloudInput& input, MeshBuilder& mesh);
/// `bytes` is the length of the input, which distinguishes binary files from text.
void read_stl(CloudInput& input, std::uint64_t bytes, MeshBuilder& mesh);

}  // namespace gdtslam
