// Thins clouds for pictures: one point per voxel, with voxels as large as the limit requires.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "engine/core/to_position.hpp"
#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/viewer/cloud_scene.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastVoxel_m = 0.002;
constexpr double kLargestVoxel_m = 1000.0;
constexpr double kAim = 0.75;     // target share of the limit
constexpr double kFull = 1.2;     // share of that target that leaves too little room
constexpr double kShare = 0.5;    // least share of the room for the first points
constexpr double kStep = 1.1892;  // ratio of successive voxel edges: 2^(1/4)

constexpr std::size_t kKeptPiece = 1U << 14U;

// In pieces, because the thinning keeps its points of a piece twice.
void add_in_pieces(CloudSink& sink, std::span<const CloudPoint> points) {
  for (; !points.empty(); points = points.subspan(std::min(kKeptPiece, points.size()))) {
    sink.add(points.first(std::min(kKeptPiece, points.size())));
  }
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

// Longest side of the points' box.
double side_m(const Cloud& cloud) {
  Bounds bounds;
  for (const CloudPoint& point : cloud) bounds.add(to_position(point));
  return bounds.is_empty() ? 0.0 : (bounds.highest - bounds.lowest).maxCoeff();
}

/// Appends points, or overwrites those already read.
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

struct PointLimit::State {
  explicit State(std::size_t with_most) : most(std::max<std::size_t>(with_most, 1)) {}

  void thin();
  void thin_to(double voxel_m);
  void coarsen_for(const Cloud& piece);

  std::size_t most;
  std::uint64_t expected = 0;
  std::uint64_t seen = 0;
  Cloud finite;  // points of the current piece
  CompactingKeeper keeper;
  std::unique_ptr<VoxelThinning> thinning;  // empty while all are kept
  double voxel_m = 0.0;
};

void PointLimit::State::thin_to(double wanted_m) {
  if (wanted_m > kLargestVoxel_m) throw InputError("the cloud is too wide to be thinned to so few points");
  voxel_m = wanted_m;
  thinning = std::make_unique<VoxelThinning>(voxel_m, std::uint64_t{1} << 40U, keeper);
  keeper.kept = 0;
  add_in_pieces(*thinning, keeper.cloud);
  keeper.cloud.resize(keeper.kept);
}

// Points are on surfaces: voxels sqrt(2) times as wide keep half of them. Points still to come need room too, unless
// they fall among the present ones.
void PointLimit::State::thin() {
  const double share = std::max(kShare, static_cast<double>(seen) / static_cast<double>(std::max(expected, seen)));
  const double aim = kAim * static_cast<double>(most) * share;
  const double least_m = least_voxel_m(keeper.cloud);
  thin_to(std::max(least_m, voxel_m == 0.0 ? side_m(keeper.cloud) / std::sqrt(4.0 * aim) : kStep * voxel_m));
  while (static_cast<double>(keeper.cloud.size()) > kFull * aim) {
    thin_to(voxel_m * std::max(kStep, std::sqrt(static_cast<double>(keeper.cloud.size()) / aim)));
  }
}

// Enlarges the voxels for points that are too far for them. It enlarges by at least a step, so that ever farther points
// rarely trigger it.
void PointLimit::State::coarsen_for(const Cloud& piece) {
  if (!thinning) return;
  const double least_m = least_voxel_m(piece);
  if (least_m > voxel_m) thin_to(std::max(least_m, kStep * voxel_m));
}

PointLimit::PointLimit(std::size_t most) : state_(std::make_unique<State>(most)) {}

PointLimit::~PointLimit() = default;

void PointLimit::expect(std::uint64_t points) {
  state_->expected = points;
  state_->keeper.cloud.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(points, state_->most)));
}

void PointLimit::add(std::span<const CloudPoint> points) {
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

Cloud PointLimit::take() {
  state_->thinning.reset();
  state_->keeper.kept = 0;
  return std::exchange(state_->keeper.cloud, {});
}

}  // namespace gdtslam
