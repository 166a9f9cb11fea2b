#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/compute/cases/case_builder.hpp"
#include "engine/compute/cases/scan_data.hpp"
#include "engine/core/elementary.hpp"
#include "point_to_line.hpp"

namespace gdtslam {
namespace {

struct LinePoint {
  float x, y, normal_x, normal_y;
};

/// Scans of a room; any ranges; the room with every other point as far as the one before, or one unit in the last place
/// farther; a wall of points 1/8 m apart, every second scan's normals turned so that their cosine is 0.8.
enum class LineShape : std::uint8_t { kHall, kRough, kTwins, kWall };
constexpr LineShape kLineShapes[] = {LineShape::kHall, LineShape::kRough, LineShape::kTwins, LineShape::kWall};
constexpr const char* kLineShapeNames[] = {" room", " rough", " twins", " wall"};

/// Points of a room's scan: behind, left, right, ahead, and one without a direction.
constexpr std::pair<float, float> kOnAxes[] = {{-3.0F, 0.0F}, {0.0F, 2.0F}, {0.0F, -2.0F}, {3.0F, 0.0F}, {0.0F, 0.0F}};

/// Scans that are turned about one place and laid on each other.
struct LineCase {
  using Kernel = PointToLine;
  std::uint32_t points = 180;  ///< without padding; some scans have one or two more
  std::uint32_t taken = 90;    ///< at most; fewer if a scan ends before
  std::uint32_t every = 2;
  std::uint32_t pairs = 3;
  LineShape shape = LineShape::kHall;
  PointToLine::Params params{.gate_m2 = 0.2F};
  float low = -2.0F;
  float high = 2.0F;
  double turned = 0.4;    ///< from a scan to the next
  double spread = 0.05;   ///< errors of the poses, m; their angles have a third of it
  double shifted = 0.0;   ///< all poses, along y
  double middle = 0.0;    ///< bearing of the middle of what the scans see, and its width
  double view = 6.28318;  ///< rad

  [[nodiscard]] std::string name() const {
    return std::to_string(pairs) + " pairs " + std::to_string(taken) + " of " + std::to_string(points) +
           " points every " + std::to_string(every) + kLineShapeNames[static_cast<std::size_t>(shape)];
  }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

double line_direction(const LinePoint& point) {
  const double length = std::fabs(static_cast<double>(point.x)) + std::fabs(static_cast<double>(point.y));
  const double share = length > 0.0 ? static_cast<double>(point.y) / length : 0.0;
  return point.x >= 0.0F ? share : (point.y >= 0.0F ? 2.0 : -2.0) - share;
}

/// The buffers' scans, and the place of each; a few values and bins belong to none.
struct LineScans {
  std::vector<float> values = {};
  std::vector<std::uint16_t> bins = {};
  std::vector<std::array<std::uint32_t, 3>> blocks = {};  ///< first value, number of points, first bin

  void add(std::vector<LinePoint> points) {
    std::ranges::stable_sort(points, {}, line_direction);
    values.resize(values.size() + 3);
    bins.resize(bins.size() + 2);
    const auto count = std::max(static_cast<std::uint32_t>(points.size()), PointToLine::kCandidates);
    blocks.push_back({static_cast<std::uint32_t>(values.size()), count, static_cast<std::uint32_t>(bins.size())});
    for (std::uint32_t bin = 0; bin < PointToLine::kBins; ++bin) {
      const auto first = std::ranges::lower_bound(points, bin / 64.0 - 2.0, {}, line_direction) - points.begin();
      bins.push_back(static_cast<std::uint16_t>(std::min<std::ptrdiff_t>(first, 65535)));
    }
    points.resize(count, {1.0e15F, 1.0e15F, 0.0F, 0.0F});
    for (const auto part : {&LinePoint::x, &LinePoint::y, &LinePoint::normal_x, &LinePoint::normal_y}) {
      for (const LinePoint& point : points) values.push_back(point.*part);
    }
  }
};

/// A return from the room's walls, or from any range.
LinePoint line_return(double bearing, double heading, bool rough, Random& random) {
  const SinCos<double> ray = sin_cos(bearing + heading);
  const double along = (ray.cos > 0.0 ? 2.6 : 3.4) / std::fabs(ray.cos);
  const double across = (ray.sin > 0.0 ? 2.3 : 1.7) / std::fabs(ray.sin);
  const double inward = std::numbers::pi * (along < across ? (ray.cos > 0.0 ? 1.0 : 0.0) : ray.sin > 0.0 ? -0.5 : 0.5);
  const double range_m = rough ? random.uniform(1.0, 4.0) : std::min(along, across) + random.normal(0.0, 0.01);
  const SinCos<double> seen = sin_cos(bearing);
  const SinCos<double> normal = sin_cos(inward - heading + random.normal(0.0, 0.3));
  return {static_cast<float>(range_m * seen.cos), static_cast<float>(range_m * seen.sin),
          static_cast<float>(normal.cos), static_cast<float>(normal.sin)};
}

std::vector<LinePoint> line_points(const LineCase& drawn, std::uint32_t scan, Random& random) {
  const std::uint32_t count = drawn.points + scan % 3;
  std::vector<LinePoint> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (drawn.shape == LineShape::kWall) {
      const float y = (static_cast<float>(i) - static_cast<float>(count) / 2.0F) / 8.0F;
      points.push_back(scan % 2 == 0 ? LinePoint{2.0F, y, -1.0F, 0.0F} : LinePoint{2.0F, y, -0.8F, 0.6F});
    } else if (drawn.shape == LineShape::kTwins && i % 2 == 1) {
      const LinePoint twin = points.back();
      const float x = i % 4 == 1 ? twin.x : std::nextafter(twin.x, 2.0F * twin.x);
      points.push_back({x, twin.y, twin.normal_y, twin.normal_x});
    } else if (drawn.shape == LineShape::kHall && count > 20 && i < std::size(kOnAxes)) {
      points.push_back({kOnAxes[i].first, kOnAxes[i].second, 0.6F, 0.8F});
    } else {
      const double bearing = drawn.middle + ((i + random.uniform()) / count - 0.5) * drawn.view;
      points.push_back(line_return(bearing, drawn.turned * scan, drawn.shape == LineShape::kRough, random));
    }
  }
  return points;
}

/// A pose with these errors; quarter turns are exact.
PointToLine::Pose line_pose(const LineCase& drawn, double turn, Random& random) {
  const auto error = [&] { return random.uniform(-drawn.spread, drawn.spread); };
  const auto rounded = [](double value) { return std::fabs(value) < 1.0e-9 ? 0.0F : static_cast<float>(value); };
  const SinCos<double> rotation = sin_cos(turn + error() / 3.0);
  return {rounded(error()), rounded(drawn.shifted + error()), rounded(rotation.sin), rounded(rotation.cos)};
}

KernelCase LineCase::make(const std::string& named) const {
  Random random(seed_from(named));
  LineScans all;
  const std::uint32_t scans = std::clamp(pairs / 10, 3U, 64U);
  for (std::uint32_t scan = 0; scan < scans; ++scan) all.add(line_points(*this, scan, random));
  std::vector<PointToLine::Pair> list(pairs);
  for (std::uint32_t p = 0; p < pairs; ++p) {
    const std::uint32_t fixed = p % scans;
    const std::uint32_t moving = p % 4 == 0 ? fixed : (7 * p + 1) % scans;
    const double turn = turned * (static_cast<double>(moving) - fixed);
    PointToLine::Pose found = line_pose(*this, turn, random);
    const PointToLine::Pose at = p % 2 == 0 ? line_pose(*this, turn, random) : found;
    if (p == 5) found.x = 1.0e15F;
    const auto& [lines, line_count, line_bin] = all.blocks[fixed];
    const auto& [value, count, bin] = all.blocks[moving];
    const std::uint32_t most = std::min(taken, (count + every - 1) / every);
    list[p] = {found, at, low, high, lines, line_count, line_bin, value, count, every, most};
  }
  CaseBuffer sums = noise_buffer(static_cast<std::uint32_t>(pairs * PointToLine::kSums), random);
  return make_case<PointToLine>(named, params, {pairs, 1, 1},
                                {list_buffer(all.values), list_buffer(all.bins), words_buffer(list), sums});
}

/// A case, and the same without errors of the poses: points may lie on themselves, on axes and at the edge of the view.
void add_twice(std::vector<KernelCaseSource>& list, LineCase drawn, const std::string& what) {
  add_case(list, drawn, what);
  drawn.spread = 0.0;
  add_case(list, drawn, what + ", no errors");
}

// Numbers of points around lanes and blocks, numbers of pairs, and scans of few points, whose padding lies on itself.
void add_line_sizes(std::vector<KernelCaseSource>& list) {
  for (const std::uint32_t taken : {0U, 1U, 31U, 32U, 33U, 127U, 128U, 129U, 300U, 2101U}) {
    for (const std::uint32_t every : {1U, 2U, 7U}) add_case(list, LineCase{taken * every, taken, every});
  }
  for (const std::uint32_t pairs : {0U, 1U, 2U, 70U}) add_case(list, LineCase{.pairs = pairs});
  for (const std::uint32_t points : {0U, 1U, 5U, 15U, 16U, 17U}) {
    const PointToLine::Params params{.gate_m2 = 4.0F, .least_cosine = points % 2 == 0 ? 0.0F : -2.0F};
    add_twice(list, LineCase{points, 17, 1, 5, LineShape::kHall, params}, ", few points");
  }
}

// Every quarter turn; parts of the room, some with more points in a bin than candidates; edges of what is in view.
void add_line_turns(std::vector<KernelCaseSource>& list) {
  using std::numbers::pi;
  for (const double quarters : {0.0, 0.7, 1.0, 1.7, 2.0, -1.0, -1.3, -1.9, 6.2}) {
    add_twice(list, LineCase{.pairs = 7, .turned = 0.5 * pi * quarters}, ", turned " + std::to_string(quarters));
  }
  for (const auto& [middle, view] : {std::pair(0.0, 2.4), {pi, 2.4}, {0.0, 0.5}, {1.5, 0.5}, {-1.5, 0.5}, {pi, 0.5}}) {
    LineCase part{.points = 600, .taken = 600, .every = 1, .pairs = 6, .turned = 0.3 * view, .middle = middle};
    part.view = view;
    add_twice(list, part, ", " + std::to_string(view) + " around " + std::to_string(middle));
  }
  for (const auto& [low, high] : {std::pair(-1.0F, 2.0F), {-2.0F, 0.5F}, {-0.7F, 0.3F}, {0.0F, 0.0F}, {2.0F, 2.0F}}) {
    add_twice(list, LineCase{.taken = 180, .every = 1, .pairs = 6, .low = low, .high = high},
              ", in view " + std::to_string(low) + " to " + std::to_string(high));
  }
}

// Gates, scales and cosines that take all points, none and some; lines that are equally near, or almost.
void add_line_gates(std::vector<KernelCaseSource>& list) {
  for (const float gate_m2 : {0.0F, 1.0e-6F, 0.16F, 1.0F, 1.0e4F, 1.0e15F}) {
    for (const LineShape shape : kLineShapes) {
      LineCase gated{.points = 400, .taken = 400, .every = 1, .pairs = 5, .shape = shape, .spread = 0.4};
      gated.params = {.gate_m2 = gate_m2, .per_kernel_m2 = 100.0F, .least_cosine = -2.0F};
      add_twice(list, gated, ", gate " + std::to_string(gate_m2));
    }
  }
  for (const auto& [scale, least] : {std::pair(0.0F, -2.0F), {1.0F, 0.99F}, {1.0e7F, 0.8F}, {493.8F, 2.0F}}) {
    add_case(list, LineCase{.params = {.per_kernel_m2 = scale, .least_cosine = least}},
             ", scale " + std::to_string(scale) + " cosine " + std::to_string(least));
  }
  // Halfway between two lines, or as good as, or beyond the wall; just within the gate and the cosine, or just not.
  for (const float shifted : {0.0625F, 4095.0F / 65536.0F, 1.0F}) {
    LineCase wall{.points = 33, .taken = 33, .every = 1, .pairs = 4, .shape = LineShape::kWall};
    wall.turned = wall.spread = 0.0;
    wall.shifted = static_cast<double>(shifted);
    wall.params = {.gate_m2 = shifted * shifted, .least_cosine = shifted < 1.0F ? 0.8F : std::nextafter(0.8F, 1.0F)};
    add_case(list, wall, ", just beyond, shifted " + std::to_string(shifted));
    wall.params = {.gate_m2 = std::nextafter(wall.params.gate_m2, 2.0F), .least_cosine = 0.8F};
    add_case(list, wall, ", just within, shifted " + std::to_string(shifted));
  }
}

void add_lines(std::vector<KernelCaseSource>& list) {
  add_line_sizes(list);
  add_line_turns(list);
  add_line_gates(list);
  add_case(list, LineCase{.pairs = 4096, .params = {}}, CaseUse::kBenchmark);
}

KernelCase draw_lines(const std::string& name, Random& random) {
  LineCase drawn{.points = draw_count(random, 400), .taken = draw_count(random, 400)};
  drawn.every = 1 + draw_count(random, 6);
  drawn.pairs = draw_count(random, 9);
  drawn.shape = draw_from(random, kLineShapes);
  drawn.params.gate_m2 = static_cast<float>(random.uniform(0.0, random.below(2) == 0 ? 0.1 : 20.0));
  drawn.params.per_kernel_m2 = static_cast<float>(random.uniform(0.0, random.below(2) == 0 ? 1000.0 : 1.0e6));
  drawn.params.least_cosine = draw_real(random, 1.5);
  if (random.below(2) == 0) drawn.low = static_cast<float>(random.uniform(-2.2, 0.0));
  if (random.below(2) == 0) drawn.high = static_cast<float>(random.uniform(0.0, 2.2));
  drawn.turned = random.uniform(-3.2, 3.2);
  drawn.spread = random.uniform(0.0, 0.3);
  drawn.view = random.uniform(0.3, 6.3);
  return drawn.make(name);
}

}  // namespace

CaseGroup PointToLine::cases() { return {add_lines, {{&PointToLine::info(), draw_lines}}}; }

}  // namespace gdtslam
