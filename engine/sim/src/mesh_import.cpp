#include "gdtslam/sim/mesh_import.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>

#include "gdtslam/core/elementary.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::sim {
namespace {

std::string extension_of(const std::string& file_name) {
  const std::size_t dot = file_name.rfind('.');
  std::string extension = dot == std::string::npos ? "" : file_name.substr(dot + 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != "obj" && extension != "stl" && extension != "ply") {
    throw InputError({file_name, 0}, "not a mesh that can be imported: use .obj, .stl or .ply");
  }
  return extension;
}

Vec3 placed(const aiVector3D& vertex, const MeshPlacement& placement, const SinCos<double>& yaw) {
  const double x = placement.scale * static_cast<double>(vertex.x);
  const double up_or_y = placement.scale * static_cast<double>(vertex.y);
  const double z_or_out = placement.scale * static_cast<double>(vertex.z);
  const double y = placement.y_is_up ? -z_or_out : up_or_y;
  const double z = placement.y_is_up ? up_or_y : z_or_out;
  return {yaw.cos * x - yaw.sin * y + placement.position_m.x(), yaw.sin * x + yaw.cos * y + placement.position_m.y(),
          z + placement.position_m.z()};
}

void append(TriangleMesh& mesh, const aiMesh& part, const MeshPlacement& placement, const SinCos<double>& yaw,
            const std::string& file_name) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (unsigned int i = 0; i < part.mNumVertices; ++i) {
    mesh.vertices.push_back(placed(part.mVertices[i], placement, yaw));
  }
  for (unsigned int i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) {
      continue;  // points and lines, which a ray cannot hit; polygons are triangles by now
    }
    for (unsigned int k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= part.mNumVertices) {
        throw InputError({file_name, 0}, "a face names a vertex that the mesh does not have: export the mesh again");
      }
    }
    mesh.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
  }
}

}  // namespace

TriangleMesh import_mesh(std::span<const std::byte> bytes, const std::string& file_name,
                         const MeshPlacement& placement) {
  const std::string extension = extension_of(file_name);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(
      bytes.data(), bytes.size(), aiProcess_Triangulate | aiProcess_PreTransformVertices, extension.c_str());
  if (scene == nullptr) {
    std::string reason = importer.GetErrorString();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    throw InputError({file_name, 0}, "cannot be read as a mesh (" + reason + "): export it again as OBJ or STL");
  }
  const SinCos<double> yaw = sin_cos(placement.yaw_rad);
  TriangleMesh mesh;
  for (unsigned int i = 0; i < scene->mNumMeshes; ++i) {
    append(mesh, *scene->mMeshes[i], placement, yaw, file_name);
  }
  if (mesh.triangles.empty()) {
    throw InputError({file_name, 0}, "holds no triangle: export it with its faces");
  }
  return mesh;
}

}  // namespace gdtslam::sim
