#include <cmath>
#include <string>

#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr int kBitsPerAxis = 21;
constexpr double kMostCells = 1 << (kBitsPerAxis - 1);  // on either side of the origin
constexpr std::uint64_t kFree = ~std::uint64_t{0};
constexpr std::size_t kFirstSlots = 1 << 12;

// The cube of a coordinate, counted from the lower end of the range.
std::uint64_t cell_of(float coordinate_m, double voxel_m) {
  const double cell = std::floor(static_cast<double>(coordinate_m) / voxel_m);
  if (!(cell >= -kMostCells && cell < kMostCells)) {
    throw InputError("a point of the cloud is " + std::to_string(std::fabs(coordinate_m)) +
                     " m from the origin, too far for cubes of " + std::to_string(voxel_m) + " m; raise cloud.voxel");
  }
  return static_cast<std::uint64_t>(cell + kMostCells);
}

// splitmix64's last steps [Steele2014]: neighbouring cubes go to slots far apart.
std::uint64_t mixed(std::uint64_t key) {
  key = (key ^ (key >> 30U)) * 0xbf58476d1ce4e5b9U;
  key = (key ^ (key >> 27U)) * 0x94d049bb133111ebU;
  return key ^ (key >> 31U);
}

}  // namespace

struct VoxelThinning::State {
  bool insert(std::uint64_t key);
  void grow();

  double voxel_m = 0.0;
  std::uint64_t max_voxels = 0;
  CloudSink& next;
  std::vector<std::uint64_t> slots = std::vector<std::uint64_t>(kFirstSlots, kFree);  // open addressing
  std::uint64_t count = 0;
  std::vector<CloudPoint> kept;
};

void VoxelThinning::State::grow() {
  std::vector<std::uint64_t> old(slots.size() * 2, kFree);
  old.swap(slots);
  const std::uint64_t mask = slots.size() - 1;
  for (const std::uint64_t key : old) {
    if (key == kFree) continue;
    std::uint64_t slot = mixed(key) & mask;
    while (slots[slot] != kFree) slot = (slot + 1) & mask;
    slots[slot] = key;
  }
}

// False when the cube has a point already. At most half of the slots are taken.
bool VoxelThinning::State::insert(std::uint64_t key) {
  const std::uint64_t mask = slots.size() - 1;
  std::uint64_t slot = mixed(key) & mask;
  for (; slots[slot] != kFree; slot = (slot + 1) & mask) {
    if (slots[slot] == key) return false;
  }
  if (count == max_voxels) {
    throw InputError("the cloud fills more than " + std::to_string(max_voxels >> 20U) + " x 2^20 cubes of " +
                     std::to_string(voxel_m) + " m; raise cloud.voxel, to " + std::to_string(2.0 * voxel_m) +
                     " for example, or cloud.max_megavoxels");
  }
  slots[slot] = key;
  if (++count * 2 > slots.size()) grow();
  return true;
}

VoxelThinning::VoxelThinning(double voxel_m, std::uint64_t max_voxels, CloudSink& next)
    : state_(new State{.voxel_m = voxel_m, .max_voxels = max_voxels, .next = next, .kept = {}}) {
  if (!(voxel_m > 0.0)) throw ConfigError("the edge of a voxel must be greater than 0");
}
VoxelThinning::~VoxelThinning() = default;
std::uint64_t VoxelThinning::kept() const { return state_->count; }

void VoxelThinning::add(std::span<const CloudPoint> points) {
  State& s = *state_;
  s.kept.clear();
  for (const CloudPoint& p : points) {
    const std::uint64_t key = cell_of(p.x_m, s.voxel_m) << (2 * kBitsPerAxis) |
                              cell_of(p.y_m, s.voxel_m) << kBitsPerAxis | cell_of(p.z_m, s.voxel_m);
    if (s.insert(key)) s.kept.push_back(p);
  }
  if (!s.kept.empty()) s.next.add(s.kept);
}

}  // namespace gdtslam
