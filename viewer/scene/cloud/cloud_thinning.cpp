// Clouds with few enough points for films: one point for each voxel, the voxels as large as that asks for.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/cloud/position_of.hpp"
#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastVoxel_m = 0.002;
constexpr double kLargestVoxel_m = 1000.0;
constexpr int kSearchSteps = 7;  // of the search: the voxel's edge to 2 %

// The thinned cloud, or nothing where it has more than `most` points; stops as soon as that is known.
class BoundedKeeper : public CloudSink {
 public:
  explicit BoundedKeeper(std::size_t most) : most_(most) {}
  void add(std::span<const CloudPoint> points) override {
    if (kept.size() + points.size() > most_) {
      is_full = true;
      return;
    }
    kept.insert(kept.end(), points.begin(), points.end());
  }
  Cloud kept;
  bool is_full = false;

 private:
  std::size_t most_;
};

struct Thinned {
  Cloud cloud;
  bool fits = false;
};
Thinned thinned(std::span<const CloudPoint> cloud, double voxel_m, std::size_t most) {
  constexpr std::size_t kKeptPiece = 1U << 16U;
  BoundedKeeper keeper(most);
  VoxelThinning thinning(voxel_m, std::uint64_t{1} << 40U, keeper);
  for (std::size_t begin = 0; begin < cloud.size() && !keeper.is_full; begin += kKeptPiece) {
    thinning.add(cloud.subspan(begin, std::min(kKeptPiece, cloud.size() - begin)));
  }
  return {.cloud = std::move(keeper.kept), .fits = !keeper.is_full};
}

double farthest_m(const Cloud& cloud) {
  float most = 0.0F;
  for (const CloudPoint& point : cloud) {
    most = std::max({most, std::fabs(point.x_m), std::fabs(point.y_m), std::fabs(point.z_m)});
  }
  return static_cast<double>(most);
}

}  // namespace

Cloud thinned_for_film(std::span<const CloudPoint> cloud, std::size_t most) {
  Cloud finite;
  finite.reserve(cloud.size());
  std::copy_if(cloud.begin(), cloud.end(), std::back_inserter(finite), is_finite);
  if (finite.size() <= most || most == 0) return most == 0 ? Cloud{} : finite;
  // Voxels are counted from the origin with 20 bits: far away they cannot be small.
  double too_fine = std::max(kLeastVoxel_m, farthest_m(finite) / (1U << 20U) * 1.01);
  double coarse = 8.0 * std::max(too_fine, 0.01);
  Thinned best = thinned(finite, coarse, most);
  while (!best.fits) {
    too_fine = coarse;
    coarse *= 2.0;
    if (coarse > kLargestVoxel_m) throw InputError("the cloud is too wide to be thinned to so few points");
    best = thinned(finite, coarse, most);
  }
  for (int step = 0; step < kSearchSteps; ++step) {
    const double middle = std::sqrt(too_fine * coarse);
    Thinned finer = thinned(finite, middle, most);
    (finer.fits ? coarse : too_fine) = middle;
    if (finer.fits) best = std::move(finer);
  }
  return std::move(best.cloud);
}

}  // namespace gdtslam
