// Clouds with few enough points for films: one point for each voxel, the voxels as large as that asks for.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "engine/cloud/position_of.hpp"
#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastVoxel_m = 0.002;
constexpr double kLargestVoxel_m = 1000.0;
constexpr double kStillAim = 0.75;     // of the most points of a still, that are aimed at,
constexpr double kStillFull = 1.2;     // and of these, that leave too little room
constexpr double kStillShare = 0.5;    // of the room, that points have at least which came first
constexpr double kStillStep = 1.1892;  // between voxels' edges: 2^(1/4)
constexpr int kSearchSteps = 7;        // of the search: the voxel's edge to 2 %

constexpr std::size_t kKeptPiece = 1U << 14U;

// The thinning holds what it keeps of a piece twice.
void add_in_pieces(CloudSink& sink, std::span<const CloudPoint> points) {
  for (; !points.empty(); points = points.subspan(std::min(kKeptPiece, points.size()))) {
    sink.add(points.first(std::min(kKeptPiece, points.size())));
  }
}

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

// Voxels are counted from the origin with 20 bits: far away they cannot be small.
double least_voxel_m(const Cloud& cloud) { return std::max(kLeastVoxel_m, farthest_m(cloud) / (1U << 20U) * 1.01); }

// Of the box of the points, the longest.
double side_m(const Cloud& cloud) {
  Bounds bounds;
  for (const CloudPoint& point : cloud) bounds.add(position_of(point));
  return bounds.is_empty() ? 0.0 : (bounds.highest - bounds.lowest).maxCoeff();
}

/// Points are appended, or written over those that were read already.
class CompactingKeeper : public CloudSink {
 public:
  void add(std::span<const CloudPoint> points) override {
    const std::size_t over = std::min(points.size(), cloud.size() - kept);
    std::copy_n(points.begin(), over, cloud.begin() + static_cast<std::ptrdiff_t>(kept));
    cloud.insert(cloud.end(), points.begin() + static_cast<std::ptrdiff_t>(over), points.end());
    kept += points.size();
  }
  Cloud cloud;
  std::size_t kept = 0;
};

}  // namespace

struct StillThinning::State {
  explicit State(std::size_t with_most) : most(std::max<std::size_t>(with_most, 1)) {}

  void thin();
  void thin_to(double voxel_m);
  void coarsen_for(const Cloud& piece);

  std::size_t most;
  std::uint64_t expected = 0;
  std::uint64_t seen = 0;
  Cloud finite;  // of a piece
  CompactingKeeper keeper;
  std::unique_ptr<VoxelThinning> thinning;  // empty while all are kept
  double voxel_m = 0.0;
};

void StillThinning::State::thin_to(double wanted_m) {
  if (wanted_m > kLargestVoxel_m) throw InputError("the cloud is too wide to be thinned to so few points");
  voxel_m = wanted_m;
  thinning = std::make_unique<VoxelThinning>(voxel_m, std::uint64_t{1} << 40U, keeper);
  keeper.kept = 0;
  add_in_pieces(*thinning, keeper.cloud);
  keeper.cloud.resize(keeper.kept);
}

// Points lie on surfaces: half as many are left by voxels sqrt(2) times as wide. What is to come needs room as well,
// but not where it lies among what has come.
void StillThinning::State::thin() {
  const double share = std::max(kStillShare, static_cast<double>(seen) / static_cast<double>(std::max(expected, seen)));
  const double aim = kStillAim * static_cast<double>(most) * share;
  const double least_m = least_voxel_m(keeper.cloud);
  thin_to(std::max(least_m, voxel_m == 0.0 ? side_m(keeper.cloud) / std::sqrt(4.0 * aim) : kStillStep * voxel_m));
  while (static_cast<double>(keeper.cloud.size()) > kStillFull * aim) {
    thin_to(voxel_m * std::max(kStillStep, std::sqrt(static_cast<double>(keeper.cloud.size()) / aim)));
  }
}

// Makes the voxels larger where a point of the piece lies too far for them; by a step at least, so that points that
// come from farther and farther away rarely ask for it.
void StillThinning::State::coarsen_for(const Cloud& piece) {
  if (!thinning) return;
  const double least_m = least_voxel_m(piece);
  if (least_m > voxel_m) thin_to(std::max(least_m, kStillStep * voxel_m));
}

StillThinning::StillThinning(std::size_t most) : state_(std::make_unique<State>(most)) {}

StillThinning::~StillThinning() = default;

void StillThinning::expect(std::uint64_t points) { state_->expected = points; }

void StillThinning::add(std::span<const CloudPoint> points) {
  State& s = *state_;
  for (; !points.empty(); points = points.subspan(std::min(kKeptPiece, points.size()))) {
    const std::span<const CloudPoint> piece = points.first(std::min(kKeptPiece, points.size()));
    s.seen += piece.size();
    s.finite.clear();
    std::copy_if(piece.begin(), piece.end(), std::back_inserter(s.finite), is_finite);
    s.coarsen_for(s.finite);
    CloudSink& next = s.thinning ? static_cast<CloudSink&>(*s.thinning) : s.keeper;
    next.add(s.finite);
    if (s.keeper.cloud.size() > s.most) s.thin();
  }
}

Cloud StillThinning::take() {
  state_->thinning.reset();
  state_->keeper.kept = 0;
  return std::exchange(state_->keeper.cloud, {});
}

Cloud thinned_for_film(std::span<const CloudPoint> cloud, std::size_t most) {
  Cloud finite;
  finite.reserve(cloud.size());
  std::copy_if(cloud.begin(), cloud.end(), std::back_inserter(finite), is_finite);
  if (finite.size() <= most || most == 0) return most == 0 ? Cloud{} : finite;
  double too_fine = least_voxel_m(finite);
  double coarse = 8.0 * std::max(too_fine, 0.01);
  Thinned best = thinned(finite, coarse, most);
  while (!best.fits) {
    too_fine = coarse;
    coarse = std::min(2.0 * coarse, kLargestVoxel_m);
    if (coarse <= too_fine) {
      const std::size_t least = thinned(finite, kLargestVoxel_m, finite.size()).cloud.size();
      throw InputError("the cloud is too wide to be thinned to so few points: to " + std::to_string(least) +
                       " at least");
    }
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
