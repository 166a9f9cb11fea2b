#include "scene/cloud_density.hpp"

#include <cmath>

namespace gdtslam {
namespace {

constexpr std::size_t kFirstSlots = 1U << 14U;
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
  for (const std::uint32_t index : drawn) {
    const std::uint64_t key = key_of(cloud[index]);
    Slot& slot = slots_[place_of(key)];
    const bool is_new = slot.key == kFree;
    slot.key = key;
    ++slot.count;
    if (is_new && ++taken_ * 2 > slots_.size()) grow();
  }
}

float CloudDensity::spacing_m(const CloudPoint& point) const {
  const std::uint32_t count = slots_[place_of(key_of(point))].count;
  return static_cast<float>(cube_m_ / std::sqrt(static_cast<double>(count > 0 ? count : 1U)));
}

}  // namespace gdtslam
