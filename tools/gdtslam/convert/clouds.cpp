#include "clouds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

#include "engine/cloud/ndt_map.hpp"
#include "engine/io/referenced_file.hpp"
#include "engine/runs/registration/ndt_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

/// Reads clouds whose points share one frame.
class CloudInputs {
 public:
  /// Passes all points of a file to a CloudWriter or an NdtMap, piece by piece.
  template <class Sink>
  void read(const std::string& path, Sink& sink) {
    CloudReader reader(path);
    reader.make_relative();
    for (Cloud piece = reader.next(); !piece.empty(); piece = reader.next()) sink.add(piece);
    if (origin_m_ && *origin_m_ != reader.origin_m()) {
      throw InputError({path, 0},
                       "lies in another square kilometre than the cloud before; subtract the same offset from both");
    }
    if (!origin_m_) remark_origin(path, reader.origin_m());
    origin_m_ = reader.origin_m();
    if (reader.skipped() == 0) return;
    print_remark(fmt::format("warning: {} points of {} are not finite and left out", reader.skipped(), path));
  }

 private:
  std::optional<std::array<double, 3>> origin_m_;
};

void merge_ndt(const std::string& path, NdtMap& map) {
  const NdtMap read = read_ndt(path);
  if (read.cell_m() != map.cell_m()) {
    throw InputError({path, 0},
                     fmt::format("has cubes of {} m, not of {} m; give --cell {}m, or convert the cloud again",
                                 read.cell_m(), map.cell_m(), read.cell_m()));
  }
  map.merge(read);
}

ConvertedClouds write_cubes(const std::vector<std::string>& inputs, const std::string& output, double cell_m) {
  NdtMap map(cell_m);
  CloudInputs clouds;
  for (const std::string& path : inputs) {
    if (is_ndt_file(path)) {
      merge_ndt(path, map);
    } else {
      clouds.read(path, map);
    }
  }
  if (map.points_left_out() > 0) {
    print_remark(fmt::format("warning: {} points lie farther than {} cubes from the origin and are left out",
                             map.points_left_out(), NdtMap::kFarthest));
  }
  return {.points = map.points(),
          .cubes = map.size(),
          .cell_m = cell_m,
          .deviation_m = plane_deviation_m(map),
          .bytes = write_ndt(output, map)};
}

ConvertedClouds write_points(const std::vector<std::string>& inputs, const std::string& output, double spacing_m) {
  ConvertedClouds result;
  CloudWriter writer(output, find_cloud_format(output));
  CloudInputs clouds;
  for (const std::string& path : inputs) {
    if (!is_ndt_file(path)) {
      clouds.read(path, writer);
      continue;
    }
    const NdtMap map = read_ndt(path);
    writer.add(sample_cloud(map, spacing_m));
    result.cubes += map.size();
    result.cell_m = map.cell_m();
    result.deviation_m = std::max(result.deviation_m, plane_deviation_m(map));
  }
  writer.finish();
  result.points = writer.points();
  result.bytes = std::filesystem::file_size(output);
  return result;
}

}  // namespace

bool is_cloud_name(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".ply" || extension == ".pcd" || extension == ".ndt";
}

ConvertedClouds convert_clouds(const std::vector<std::string>& inputs, const std::string& output, double cell_m,
                               double spacing_m) {
  return is_ndt_file(output) ? write_cubes(inputs, output, cell_m) : write_points(inputs, output, spacing_m);
}

}  // namespace gdtslam
