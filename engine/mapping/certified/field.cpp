#include "field.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

// Half widths of the squares, in cells, for boxes of 2, 4, 8, 16 and 32 cells. A square must hold half a box, half a
// sample and the motion of a point by the box's angle, so the four of a level serve points at growing ranges.
struct LevelPlan {
  std::int32_t spacing_bits;
  std::array<std::int32_t, BoundLevel::kDilations> dilation_cells;
};
constexpr std::array<LevelPlan, 5> kPlan{
    {{1, {2, 3, 4, 5}}, {2, {3, 4, 5, 7}}, {3, {6, 8, 10, 14}}, {4, {12, 16, 20, 28}}, {5, {24, 32, 40, 56}}}};
constexpr std::int32_t kMostSampleBits = 2;  // samples a box side, as a power of two

struct Bytes {
  CellIndex origin;
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::uint8_t> cells;
};

// The field in bytes, rounded down, with a margin for the largest square.
Bytes to_bytes(const FieldView& field, std::uint32_t unit, std::int32_t room) {
  const auto width = static_cast<std::int32_t>(field.width);
  const auto height = static_cast<std::int32_t>(field.height);
  Bytes bytes;
  bytes.origin = {aligned_down(field.first_cell.x - room), aligned_down(field.first_cell.y - room)};
  const CellIndex end{-aligned_down(-(field.first_cell.x + width + room)),
                      -aligned_down(-(field.first_cell.y + height + room))};
  bytes.width = static_cast<std::size_t>(end.x - bytes.origin.x);
  bytes.height = static_cast<std::size_t>(end.y - bytes.origin.y);
  bytes.cells.assign(bytes.width * bytes.height, static_cast<std::uint8_t>(field.cap / unit));
  const float per_unit = 1.0F / static_cast<float>(unit);
  const auto shift_x = static_cast<std::size_t>(field.first_cell.x - bytes.origin.x);
  const auto shift_y = static_cast<std::size_t>(field.first_cell.y - bytes.origin.y);
  for (std::size_t y = 0; y < field.height; ++y) {
    std::uint8_t* row = &bytes.cells[(y + shift_y) * bytes.width + shift_x];
    const std::uint16_t* from = field.cells + y * field.stride;
    // The quotient rounded down, exactly: half a step more than the value is never near a whole number of units.
    for (std::size_t x = 0; x < field.width; ++x) {
      const auto value = static_cast<float>(std::min(from[x], field.cap));
      row[x] = static_cast<std::uint8_t>((value + 0.5F) * per_unit);
    }
  }
  return bytes;
}

// Keeps the lesser of each value and the one `shift` after it, front to back. Values read ahead are copied first, so
// that the compiler can exclude overlapping writes.
void keep_lesser(std::uint8_t* values, std::size_t shift, std::size_t count) {
  constexpr std::size_t kPiece = 256;
  std::uint8_t ahead[kPiece];
  std::size_t i = 0;
  for (; i + kPiece <= count; i += kPiece) {
    std::memcpy(ahead, values + i + shift, kPiece);
    for (std::size_t k = 0; k < kPiece; ++k) values[i + k] = std::min(values[i + k], ahead[k]);
  }
  for (; i < count; ++i) values[i] = std::min(values[i], values[i + shift]);
}

// The least of each `window` successive values, in place, by doubling; returns the number of remaining values.
std::size_t slide(std::uint8_t* values, std::size_t count, std::size_t window, std::size_t step) {
  std::size_t covered = 1;
  while (covered < window) {
    const std::size_t shift = std::min(covered, window - covered);
    count -= shift * step;
    keep_lesser(values, shift * step, count);
    covered += shift;
  }
  return count;
}

// Enlarges squares by `more` cells on every side; outside the edge counts as the edge's value, the cap. `tall` is
// scratch.
void dilate(Bytes& bytes, std::int32_t more, std::vector<std::uint8_t>& tall) {
  if (more <= 0) return;
  const auto side = static_cast<std::size_t>(more);
  const std::uint8_t outside = bytes.cells.front();
  std::vector<std::uint8_t> line(bytes.width + 2 * side);
  for (std::size_t y = 0; y < bytes.height; ++y) {
    std::uint8_t* row = &bytes.cells[y * bytes.width];
    std::fill(line.begin(), line.end(), outside);
    std::memcpy(line.data() + side, row, bytes.width);
    slide(line.data(), line.size(), 2 * side + 1, 1);
    std::memcpy(row, line.data(), bytes.width);
  }
  tall.resize((bytes.height + 2 * side) * bytes.width);
  std::memset(tall.data(), outside, side * bytes.width);
  std::memset(tall.data() + tall.size() - side * bytes.width, outside, side * bytes.width);
  std::memcpy(&tall[side * bytes.width], bytes.cells.data(), bytes.cells.size());
  slide(tall.data(), tall.size(), 2 * side + 1, bytes.width);
  std::memcpy(bytes.cells.data(), tall.data(), bytes.cells.size());
}

std::int32_t plan_phase_bits(const LevelPlan& plan) { return std::min(plan.spacing_bits, kMostSampleBits); }

// Samples along a side of a plane for this many cells.
std::uint64_t plane_side(std::uint64_t cells, const LevelPlan& plan) {
  return (cells >> static_cast<unsigned>(plan.spacing_bits)) + 2 * std::uint64_t{BoundLevel::kMargin};
}

// Bytes of a level for one dilation.
std::uint64_t count_samples(std::uint64_t width, std::uint64_t height, const LevelPlan& plan) {
  return (plane_side(width, plan) * plane_side(height, plan)) << static_cast<unsigned>(2 * plan_phase_bits(plan));
}

// Upper limit of the side of the field in bytes, whose margin is rounded, for a field of this many cells.
std::uint64_t most_side(std::uint64_t cells, std::span<const LevelPlan> plans) {
  return cells + 2 * static_cast<std::uint64_t>(plans.back().dilation_cells.back() + kBoundAlignment);
}

// Words of a field of minorants.
std::uint64_t minorant_words(std::uint64_t width, std::uint64_t height) {
  constexpr std::uint64_t kMargins = 2 * std::uint64_t{FieldMinorant::kMargin};
  return (width + kMargins) * (height + kMargins);
}

BoundLevel empty_level(const Bytes& bytes, const LevelPlan& plan) {
  BoundLevel level;
  level.spacing_bits = plan.spacing_bits;
  level.phase_bits = plan_phase_bits(plan);
  level.origin = bytes.origin;
  level.width = static_cast<std::uint32_t>(plane_side(bytes.width, plan));
  level.height = static_cast<std::uint32_t>(plane_side(bytes.height, plan));
  level.dilation_cells = plan.dilation_cells;
  const std::size_t dilation = count_samples(bytes.width, bytes.height, plan);
  for (std::size_t k = 0; k < BoundLevel::kDilations; ++k) {
    level.first_sample[k] = static_cast<std::uint32_t>(k * dilation);
  }
  level.samples.assign(BoundLevel::kDilations * dilation, bytes.cells.front());
  return level;
}

template <std::size_t kSpacing>
void take_row(const std::uint8_t* from, std::size_t count, std::uint8_t* to) {
  for (std::size_t x = 0; x < count; ++x) to[x] = from[x * kSpacing];
}

// Constant spacings let the compiler vectorise.
void take_row(const std::uint8_t* from, std::int32_t spacing_bits, std::size_t count, std::uint8_t* to) {
  switch (spacing_bits) {
    case 1:
      return take_row<2>(from, count, to);
    case 2:
      return take_row<4>(from, count, to);
    case 3:
      return take_row<8>(from, count, to);
    case 4:
      return take_row<16>(from, count, to);
    default:
      return take_row<32>(from, count, to);
  }
}

// Takes the samples of a dilation out of the field, plane by plane.
void take_samples(const Bytes& bytes, std::size_t dilation, BoundLevel& level) {
  const std::size_t spacing = std::size_t{1} << static_cast<unsigned>(level.spacing_bits);
  const std::size_t sample = std::size_t{1} << static_cast<unsigned>(level.sample_bits());
  const std::size_t phases = spacing / sample;
  std::uint8_t* plane = &level.samples[level.first_sample[dilation]];
  for (std::size_t phase = 0; phase < phases * phases; ++phase) {
    const std::uint8_t* from = &bytes.cells[(phase / phases) * sample * bytes.width + (phase % phases) * sample];
    for (std::size_t y = 0; y < bytes.height / spacing; ++y) {
      std::uint8_t* row = plane + (y + BoundLevel::kMargin) * level.width + BoundLevel::kMargin;
      take_row(from + y * spacing * bytes.width, level.spacing_bits, bytes.width / spacing, row);
    }
    plane += std::size_t{level.width} * level.height;
  }
}

MinorantLevels make_minorants(const FieldView& field, Isa isa) {
  constexpr std::uint32_t kMargins = 2 * FieldMinorant::kMargin;
  MinorantLevels levels{.width = field.width + kMargins,
                        .height = field.height + kMargins,
                        .constant_unit = FieldMinorant::unit_for(field.cap),
                        .first_word = {},
                        .words = {}};
  const std::size_t words = std::size_t{levels.width} * levels.height;
  levels.words.resize(words * MinorantLevels::kReaches.size());
  for (std::size_t k = 0; k < MinorantLevels::kReaches.size(); ++k) {
    levels.first_word[k] = static_cast<std::uint32_t>(k * words);
    const FieldMinorant::Params params{.width = field.width,
                                       .height = field.height,
                                       .stride = field.stride,
                                       .cap = field.cap,
                                       .reach = MinorantLevels::kReaches[k],
                                       .constant_unit = levels.constant_unit};
    field_minorant_host(isa, params, field.cells, levels.words.data() + k * words);
  }
  return levels;
}

std::span<const LevelPlan> plans_for(CertifiedMap::Windows windows) {
  const std::span<const LevelPlan> all(kPlan);
  if (windows == CertifiedMap::kNearWindows) return all.first(1);
  return windows == CertifiedMap::kSmallWindows ? all.first(3) : all;
}

}  // namespace

std::int32_t aligned_down(std::int32_t cell) { return cell & ~(kBoundAlignment - 1); }

BoundFields::BoundFields(const FieldView& field, Isa isa, CertifiedMap::Windows windows)
    : unit_(std::max(1U, (field.cap + 254U) / 255U)) {
  require_countable(field.width, field.height, windows);
  if (windows == CertifiedMap::kAnyWindows) minorants_ = make_minorants(field, isa);
  const std::span<const LevelPlan> plans = plans_for(windows);
  const Bytes plain = to_bytes(field, unit_, plans.back().dilation_cells.back() + 1);
  Bytes dilated = plain;
  std::vector<std::uint8_t> scratch;
  std::int32_t reached = 0;
  for (const LevelPlan& plan : plans) {
    if (plan.dilation_cells.front() < reached) {
      dilated.cells = plain.cells;
      reached = 0;
    }
    BoundLevel level = empty_level(plain, plan);
    for (std::size_t k = 0; k < BoundLevel::kDilations; ++k) {
      dilate(dilated, plan.dilation_cells[k] - reached, scratch);
      reached = plan.dilation_cells[k];
      take_samples(dilated, k, level);
    }
    levels_.insert(levels_.begin(), std::move(level));
  }
}

std::size_t BoundFields::bytes() const {
  std::size_t sum = minorants_.words.size() * sizeof(std::uint32_t);
  for (const BoundLevel& level : levels_) sum += level.samples.size();
  return sum;
}

// The field in bytes exists three times: as it is, widened, and once more during widening.
std::uint64_t BoundFields::most_bytes(std::uint64_t width, std::uint64_t height, CertifiedMap::Windows windows) {
  const std::span<const LevelPlan> plans = plans_for(windows);
  const std::uint64_t wide = most_side(width, plans);
  const std::uint64_t high = most_side(height, plans);
  std::uint64_t sum = 3 * wide * high;
  for (const LevelPlan& plan : plans) sum += BoundLevel::kDilations * count_samples(wide, high, plan);
  if (windows != CertifiedMap::kAnyWindows) return sum;
  return sum + minorant_words(width, height) * MinorantLevels::kReaches.size() * sizeof(std::uint32_t);
}

// The kernels add an index within a field to the field's first index, so all fields of a level are counted together.
void BoundFields::require_countable(std::uint64_t width, std::uint64_t height, CertifiedMap::Windows windows) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  const std::span<const LevelPlan> plans = plans_for(windows);
  const std::uint64_t wide = most_side(width, plans);
  const std::uint64_t high = most_side(height, plans);
  bool is_countable = std::max(width, height) <= kMost / 2;  // or 64 bits would not count them either
  for (const LevelPlan& plan : plans) {
    is_countable = is_countable && count_samples(wide, high, plan) <= kMost / BoundLevel::kDilations;
  }
  if (windows == CertifiedMap::kAnyWindows) {
    is_countable = is_countable && minorant_words(width, height) <= kMost / MinorantLevels::kReaches.size();
  }
  if (is_countable) return;
  throw InputError("the map of " + std::to_string(width) + " x " + std::to_string(height) +
                   " cells is too large to be searched in with proof (2^30 cells at most); cut a piece out of it, or "
                   "map with a larger map.resolution");
}

}  // namespace gdtslam
