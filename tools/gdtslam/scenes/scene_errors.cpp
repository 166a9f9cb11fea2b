#include "scene_errors.hpp"

#include <algorithm>
#include <thread>

#include "engine/sim/surface_distance.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "scene_file.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kPiece = 65536;
constexpr std::size_t kFewestPerThread = 1024;

// Every thread measures its own range of the points, so the results keep the points' order.
void measure(const sim::SurfaceDistance& surfaces, const CloudFrame& frame, const Cloud& points,
             std::vector<double>& distances_m) {
  distances_m.resize(points.size());
  const auto measure_stretch = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      distances_m[i] = surfaces.nearest(frame.in_truth(points[i])).distance_m;
    }
  };
  const std::size_t threads = std::clamp<std::size_t>(points.size() / kFewestPerThread, 1,
                                                      std::max<std::size_t>(std::thread::hardware_concurrency(), 1));
  std::vector<std::jthread> others;
  for (std::size_t k = 1; k < threads; ++k) {
    others.emplace_back(measure_stretch, points.size() * k / threads, points.size() * (k + 1) / threads);
  }
  measure_stretch(0, points.size() / threads);
}

}  // namespace

SceneErrors scene_errors(const SceneErrorsJob& job) {
  SceneErrors errors;
  CloudReader cloud(job.cloud);
  errors.scene_file = find_scene(job.scene, job.scene_folders);
  const sim::SurfaceDistance surfaces(triangulated(read_scene(errors.scene_file).scene, errors.scene_file),
                                      {job.embree_isa});
  errors.triangles = surfaces.mesh().triangles.size();
  const auto expected = static_cast<double>(std::max<std::uint64_t>(cloud.header().points, 1));
  std::vector<double> distances_m;
  for (Cloud piece = cloud.next(kPiece); !piece.empty(); piece = cloud.next(kPiece)) {
    measure(surfaces, job.frame, piece, distances_m);
    for (const double distance_m : distances_m) errors.distances.add(distance_m);
    const std::uint64_t count = errors.distances.count();
    if (job.progress) job.progress(count, static_cast<double>(count) / expected);
    if (job.stop && job.stop()) {
      errors.interrupted = true;
      break;
    }
  }
  errors.skipped = cloud.skipped();
  return errors;
}

}  // namespace gdtslam
