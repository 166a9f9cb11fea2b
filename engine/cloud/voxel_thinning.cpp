#include <algorithm>
#include <array>
#include <charconv>
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
constexpr std::size_t kAhead = 64;  // points whose slots are fetched from memory together

std::string as_text(double value) {
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), end};
}

[[noreturn]] void fail_far(float coordinate_m, double voxel_m) {
  const double most_m = kMostCells * voxel_m;
  throw InputError("a coordinate of the cloud is " + as_text(static_cast<double>(coordinate_m)) + " m; with cubes of " +
                   as_text(voxel_m) + " m it must lie within " + as_text(most_m) + " m; raise cloud.voxel");
}

[[noreturn]] void fail_full(std::uint64_t max_voxels, double voxel_m) {
  throw InputError("the cloud fills more than " + std::to_string(max_voxels) + " cubes of " + as_text(voxel_m) +
                   " m; raise cloud.voxel, to " + as_text(2.0 * voxel_m) + " for example, or cloud.max_megavoxels");
}

/// Cubes of one size along an axis.
class CubeGrid {
 public:
  explicit CubeGrid(double voxel_m) : voxel_m_(voxel_m), per_m_(1.0 / voxel_m) {}

  /// Cell of a coordinate, counted from the lower end of the range: floor(coordinate / edge). The product with the
  /// inverse is off by less than kNear and is used unless the coordinate is that close to the edge of a cube.
  [[nodiscard]] std::uint64_t cube_index(float coordinate_m) const {
    double cell = static_cast<double>(coordinate_m) * per_m_;
    if (!(cell >= -kMostCells && cell < kMostCells)) {  // true for NaN too
      cell = static_cast<double>(coordinate_m) / voxel_m_;
      if (!(cell >= -kMostCells && cell < kMostCells)) fail_far(coordinate_m, voxel_m_);
    }
    const auto nearest = static_cast<double>(static_cast<std::int64_t>(cell + (cell < 0.0 ? -0.5 : 0.5)));
    if (std::fabs(cell - nearest) < kNear) cell = static_cast<double>(coordinate_m) / voxel_m_;
    if (!(cell < kMostCells)) fail_far(coordinate_m, voxel_m_);
    const auto towards_zero = static_cast<std::int64_t>(cell);
    const std::int64_t below = static_cast<double>(towards_zero) > cell ? 1 : 0;
    return static_cast<std::uint64_t>(towards_zero - below + static_cast<std::int64_t>(kMostCells));
  }

 private:
  static constexpr double kNear = 1e-6;  // 2^20 cubes with 2^-51 of error are far below
  double voxel_m_;
  double per_m_;
};

// A voxel as a bit of its block of 4 x 4 x 4: surfaces fill a good part of the blocks that they cross.
struct BlockBit {
  std::uint64_t block = 0;
  std::uint64_t bit = 0;
};
BlockBit block_bit(const CloudPoint& p, const CubeGrid& grid) {
  const std::uint64_t x = grid.cube_index(p.x_m);
  const std::uint64_t y = grid.cube_index(p.y_m);
  const std::uint64_t z = grid.cube_index(p.z_m);
  return {.block = (x >> 2U) << (2 * kBitsPerAxis) | (y >> 2U) << kBitsPerAxis | z >> 2U,
          .bit = std::uint64_t{1} << ((x & 3U) | (y & 3U) << 2U | (z & 3U) << 4U)};
}

// splitmix64's last steps [Steele2014]: neighbouring cubes get slots far apart.
std::uint64_t mixed(std::uint64_t key) {
  key = (key ^ (key >> 30U)) * 0xbf58476d1ce4e5b9U;
  key = (key ^ (key >> 27U)) * 0x94d049bb133111ebU;
  return key ^ (key >> 31U);
}

}  // namespace

struct VoxelThinning::State {
  struct Block {
    std::uint64_t key = kFree;
    std::uint64_t voxels = 0;
  };
  void take(std::span<const CloudPoint> points);
  bool insert(const BlockBit& place, std::uint64_t hash);
  void grow();

  double voxel_m = 0.0;
  std::uint64_t max_voxels = 0;
  CloudSink& next;
  std::vector<Block> slots = std::vector<Block>(kFirstSlots);  // open addressing
  std::size_t taken = 0;                                       // slots taken
  std::uint64_t count = 0;
  std::vector<CloudPoint> kept;
};

void VoxelThinning::State::grow() {
  std::vector<Block> old(slots.size() * 2);
  old.swap(slots);
  const std::uint64_t mask = slots.size() - 1;
  for (const Block& block : old) {
    if (block.key == kFree) continue;
    std::uint64_t slot = mixed(block.key) & mask;
    while (slots[slot].key != kFree) slot = (slot + 1) & mask;
    slots[slot] = block;
  }
}

// Returns false if the cube has a point already. At most half of the slots are taken.
bool VoxelThinning::State::insert(const BlockBit& place, std::uint64_t hash) {
  const std::uint64_t mask = slots.size() - 1;
  std::uint64_t slot = hash & mask;
  while (slots[slot].key != place.block && slots[slot].key != kFree) slot = (slot + 1) & mask;
  Block& block = slots[slot];
  if ((block.voxels & place.bit) != 0) return false;
  if (count == max_voxels) fail_full(max_voxels, voxel_m);
  ++count;
  block.voxels |= place.bit;
  if (block.key != kFree) return true;
  block.key = place.block;
  if (++taken * 2 > slots.size()) grow();
  return true;
}

// Slots are scattered in memory, so all are prefetched before the first of them is needed.
void VoxelThinning::State::take(std::span<const CloudPoint> points) {
  std::array<BlockBit, kAhead> places{};
  std::array<std::uint64_t, kAhead> hashes{};
  const std::uint64_t mask = slots.size() - 1;
  const CubeGrid grid(voxel_m);
  for (std::size_t k = 0; k < points.size(); ++k) {
    places[k] = block_bit(points[k], grid);
    hashes[k] = mixed(places[k].block);
    __builtin_prefetch(&slots[hashes[k] & mask], 1);
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (insert(places[k], hashes[k])) kept.push_back(points[k]);
  }
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
  for (; !points.empty(); points = points.subspan(std::min(kAhead, points.size()))) {
    s.take(points.first(std::min(kAhead, points.size())));
  }
  if (!s.kept.empty()) s.next.add(s.kept);
}

}  // namespace gdtslam
