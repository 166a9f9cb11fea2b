#include <algorithm>
#include <array>

#include "gdtslam/core/random.hpp"
#include "kernel_cases.hpp"

namespace gdtslam {
namespace {

/// A grid of seeds that patterns draw on.
struct Canvas {
  std::vector<std::uint8_t>& cells;
  std::uint32_t width;
  std::uint32_t height;
  std::uint32_t stride;

  std::uint8_t& at(std::uint64_t x, std::uint64_t y) const { return cells[y * stride + x]; }
  [[nodiscard]] std::uint64_t count() const { return std::uint64_t{width} * height; }
};

void scatter(const Canvas& canvas, Random& random, double share) {
  for (std::uint32_t y = 0; y < canvas.height; ++y) {
    for (std::uint32_t x = 0; x < canvas.width; ++x) {
      const auto value = static_cast<std::uint8_t>(1 + random.below(255));
      canvas.at(x, y) = random.uniform() < share ? value : std::uint8_t{0};
    }
  }
}

/// One straight wall, mostly along an axis as in buildings; returns the cells it added.
std::uint64_t draw_wall(const Canvas& canvas, Random& random) {
  const auto longest = std::max<std::uint64_t>(4, std::min(canvas.width, canvas.height) / 5);
  const std::uint64_t length = longest / 4 + random.below(longest);
  const std::uint64_t direction = random.below(10);  // 0..4 along x, 5..8 along y, 9 diagonal
  const std::uint64_t step_x = direction < 5 || direction == 9 ? 1 : 0;
  const std::uint64_t step_y = direction >= 5 ? 1 : 0;
  std::uint64_t x = random.below(canvas.width);
  std::uint64_t y = random.below(canvas.height);
  std::uint64_t added = 0;
  for (std::uint64_t i = 0; i < length && x < canvas.width && y < canvas.height; ++i, x += step_x, y += step_y) {
    added += canvas.at(x, y) == 0 ? 1U : 0U;
    canvas.at(x, y) = 1;
  }
  return added;
}

void draw_walls(const Canvas& canvas, Random& random) {
  for (std::uint64_t drawn = 0; drawn * 1000 < canvas.count() * 15;) {
    drawn += draw_wall(canvas, random);
  }
}

// Arguments of a call are evaluated in any order, so random numbers must not be drawn in them.
void draw_one(const Canvas& canvas, Random& random) {
  const auto y = random.below(canvas.height);
  canvas.at(random.below(canvas.width), y) = 1;
}

void draw(SeedPattern pattern, const Canvas& canvas, Random& random) {
  switch (pattern) {
    case SeedPattern::kNone:
      return;
    case SeedPattern::kOne:
      draw_one(canvas, random);
      return;
    case SeedPattern::kSparse:
      scatter(canvas, random, 0.01);
      return;
    case SeedPattern::kHalf:
      scatter(canvas, random, 0.5);
      return;
    case SeedPattern::kAll:
      scatter(canvas, random, 1.0);
      return;
    case SeedPattern::kCorners:
      canvas.at(0, 0) = canvas.at(canvas.width - 1, 0) = 1;
      canvas.at(0, canvas.height - 1) = canvas.at(canvas.width - 1, canvas.height - 1) = 1;
      return;
    case SeedPattern::kChecks:  // every eighth cell both ways: many cells lie equally far from two and four seeds
      for (std::uint32_t y = 0; y < canvas.height; y += 8) {
        for (std::uint32_t x = 0; x < canvas.width; x += 8) {
          canvas.at(x, y) = 1;
        }
      }
      return;
    case SeedPattern::kWalls:
      draw_walls(canvas, random);
      return;
  }
}

}  // namespace

std::string_view to_string(SeedPattern pattern) {
  static constexpr std::array<std::string_view, 8> kNames{"none", "one",     "1%",     "50%",
                                                          "all",  "corners", "checks", "walls"};
  static_assert(kNames.size() == static_cast<std::size_t>(SeedPattern::kWalls) + 1);
  return kNames.at(static_cast<std::size_t>(pattern));
}

std::vector<std::uint8_t> make_seeds(SeedPattern pattern, std::uint32_t width, std::uint32_t height,
                                     std::uint32_t stride, std::uint64_t random_seed) {
  std::vector<std::uint8_t> cells(std::size_t{stride} * height, 0);
  const Canvas canvas{cells, width, height, stride};
  if (canvas.count() == 0) {
    return cells;
  }
  Random random(random_seed);
  draw(pattern, canvas, random);
  for (std::uint32_t y = 0; y < height; ++y) {
    std::fill(cells.begin() + std::ptrdiff_t{y} * stride + width, cells.begin() + (std::ptrdiff_t{y} + 1) * stride,
              std::uint8_t{1});  // a kernel that reads the padding finds seeds there
  }
  return cells;
}

}  // namespace gdtslam
