// Triangles from PLY and STL files. Coordinates are the file's, in single precision and in its unit. Polygons
// become triangles in the order of the file; colours, normals and other properties are skipped. Cost: one pass; memory
// follows the data read, never a number stated by the file. Thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace gdtslam {

struct MeshFile {
  std::vector<std::array<float, 3>> vertices;  ///< each is a corner of at least one triangle
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct MeshReadOptions {
  std::size_t max_triangles = 8'000'000;  ///< at most three times as many vertices are read
  std::function<bool()> stop{};           ///< called repeatedly; true ends the reading
};

/// The format follows the extension of the name. Throws FileError if it cannot be read or is no regular file,
/// InputError with the line (in binary files the vertex, face or triangle) if it is no mesh, has no triangle or exceeds
/// a bound, and Error with ExitCode::kInterrupted if it is stopped.
MeshFile read_mesh(const std::string& path, const MeshReadOptions& options = {});
/// The same for bytes in memory.
MeshFile read_mesh(std::span<const std::byte> data, const std::string& name, const MeshReadOptions& options = {});

}  // namespace gdtslam
