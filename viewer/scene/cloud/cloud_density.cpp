#include "cloud_density.hpp"

#include <algorithm>
#include <cmath>

#include "cloud_colours.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kFirstSlots = 1U << 14U;
constexpr std::size_t kDensitySample = 20000;  // of points, for what is common
constexpr double kCubesAlong = 400.0;          // the finest measure: cubes along the cloud's longest side
constexpr double kLeastCube_m = 0.02;
constexpr double kCoarsestCubesAlong = 10.0;
constexpr double kGapsPerCube = 3.0;    // at least, along a cube's edge, so that counting says something
constexpr double kLargestGap_m = 0.05;  // beyond it points lie alone, and are shown so,
constexpr double kGapsPerMedian = 2.0;  // but for clouds that are all sparse
constexpr int kBits = 21;  // of a coordinate in a key; farther cubes fall together, which only makes points smaller

std::uint64_t cell_of(float coordinate_m, double cube_m) {
  const auto cell = static_cast<std::int64_t>(std::floor(static_cast<double>(coordinate_m) / cube_m));
  return static_cast<std::uint64_t>(cell) & ((std::uint64_t{1} << kBits) - 1);
}

// splitmix64's last steps [Steele2014].
std::uint64_t mixed(std::uint64_t key) {
  key = (key ^ (key >> 30U)) * 0xbf58476d1ce4e5b9U;
  key = (key ^ (key >> 27U)) * 0x94d049bb133111ebU;
  return key ^ (key >> 31U);
}

}  // namespace

std::uint64_t CloudDensity::key_of(const CloudPoint& point) const {
  return cell_of(point.x_m, cube_m_) << (2 * kBits) | cell_of(point.y_m, cube_m_) << kBits |
         cell_of(point.z_m, cube_m_);
}

std::size_t CloudDensity::place_of(std::uint64_t key) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = mixed(key) & mask;
  while (slots_[slot].key != kFree && slots_[slot].key != key) slot = (slot + 1) & mask;
  return slot;
}

void CloudDensity::grow() {
  std::vector<Slot> old(slots_.size() * 2);
  old.swap(slots_);
  for (const Slot& slot : old) {
    if (slot.key != kFree) slots_[place_of(slot.key)] = slot;
  }
}

CloudDensity::CloudDensity(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn, double cube_m)
    : cube_m_(cube_m), slots_(kFirstSlots) {
  for (const std::uint32_t k : drawn) count(key_of(cloud[k]));
}

void CloudDensity::count(std::uint64_t key) {
  Slot& slot = slots_[place_of(key)];
  const bool is_new = slot.key == kFree;
  slot.key = key;
  ++slot.count;
  if (is_new && ++taken_ * 2 > slots_.size()) grow();
}

float CloudDensity::spacing_m(const CloudPoint& point) const {
  const std::uint32_t count = slots_[place_of(key_of(point))].count;
  return static_cast<float>(cube_m_ / std::sqrt(static_cast<double>(count > 0 ? count : 1U)));
}

CloudGaps::CloudGaps(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn, double longest_side_m) {
  const std::size_t step = std::max<std::size_t>(1, drawn.size() / kDensitySample);
  for (double cube_m = std::max(kLeastCube_m, longest_side_m / kCubesAlong);; cube_m *= 2.0) {
    density_.emplace(cloud, drawn, cube_m);
    std::vector<float> gaps;
    for (std::size_t k = 0; k < drawn.size(); k += step) gaps.push_back(density_->spacing_m(cloud[drawn[k]]));
    const auto median_m = static_cast<double>(percentile(gaps, 0.5));
    largest_m_ = std::max(kLargestGap_m, kGapsPerMedian * median_m);
    if (median_m * kGapsPerCube <= cube_m || cube_m * kCoarsestCubesAlong > longest_side_m) return;
  }
}

bool CloudGaps::is_alone(const CloudPoint& point) const {
  return static_cast<double>(density_->spacing_m(point)) > largest_m_;
}

double CloudGaps::at_m(const CloudPoint& point) const {
  return std::min(static_cast<double>(density_->spacing_m(point)), largest_m_);
}

}  // namespace gdtslam
