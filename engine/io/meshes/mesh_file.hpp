// Triangles from PLY and STL files. Coordinates are the file's, in single precision and in its unit. Polygons
// become triangles in the order of the file; colours, normals and other properties are read over. Cost: one pass;
// memory follows what has been read, never a number that the file states. Thread-safe.
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
  std::vector<std::array<float, 3>> vertices;  ///< each is a corner of a triangle at least
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct MeshReadOptions {
  std::size_t max_triangles = 8'000'000;  ///< three times as many vertices are read at most
  std::function<bool()> stop{};           ///< asked again and again; true ends the reading
};

/// The format follows the extension of the name. Throws FileError for what cannot be read or is no regular file,
/// InputError with the line (in binary files the vertex, face or triangle) for what is no mesh, holds no triangle or is
/// beyond a bound, and Error with ExitCode::kInterrupted when it is stopped.
MeshFile read_mesh(const std::string& path, const MeshReadOptions& options = {});
/// The same of bytes in memory.
MeshFile read_mesh(std::span<const std::byte> data, const std::string& name, const MeshReadOptions& options = {});

}  // namespace gdtslam
