#include "mesh_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/referenced_file.hpp"
#include "mesh_builder.hpp"

namespace gdtslam {
namespace {

MeshFile read_mesh(std::unique_ptr<ByteSource> source, std::uint64_t bytes, const std::string& name,
                   const MeshReadOptions& options) {
  const std::string extension = extension_of(name);
  if (extension != ".ply" && extension != ".stl") {
    throw InputError({name, 0}, "is not a mesh that can be read: export it as .ply or .stl");
  }
  if (bytes > kMaxMeshBytes) {
    throw InputError({name, 0},
                     fmt::format("is longer than the {} MiB that are read: simplify the mesh", kMaxMeshBytes >> 20U));
  }
  CloudInput input(std::move(source), name);
  MeshBuilder mesh(options, name);
  if (extension == ".stl") {
    read_stl(input, bytes, mesh);
  } else {
    read_ply_mesh(input, mesh);
  }
  return mesh.finish();
}

}  // namespace

MeshFile read_mesh(const std::string& path, const MeshReadOptions& options) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) throw FileError(path, "cannot be read as a mesh: " + error.message());
  return read_mesh(open_file_source(path), bytes, path, options);
}

MeshFile read_mesh(std::span<const std::byte> data, const std::string& name, const MeshReadOptions& options) {
  return read_mesh(open_memory_source(data), data.size(), name, options);
}

}  // namespace gdtslam
