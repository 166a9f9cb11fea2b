#include "engine/compute/cases/case_builder.hpp"
#include "engine/compute/cases/scan_data.hpp"
#include "pose_descent.hpp"

namespace gdtslam {
namespace {

float around(float middle, double spread, Random& random) {
  return middle + static_cast<float>(random.uniform(-spread, spread));
}

/// Priors: none, one with about the weight of the points, one at its limit everywhere except near the mean, one whose
/// curvature is hardly more than singular, one whose part in theta alone is at its limit.
enum class DescentPriorKind : std::uint8_t { kNone, kWeak, kSteep, kFaint, kSteepTurn };

struct DescentCase {
  using Kernel = PoseDescent;
  CaseSize field{256, 200, 256};
  bool room = true;  ///< else a field without any shape
  std::uint32_t points = 180;
  std::uint32_t poses = 3;
  std::uint32_t cap = 20 * 256;
  DescentPriorKind prior = DescentPriorKind::kNone;
  std::uint32_t max_evaluations = 40;
  float width = 5120.0F;
  float narrowing = 0.5F;
  float last_width = 1280.0F;
  float stop_cells = 0.01F;
  float stop_rad = 0.0002F;
  bool odd_poses = true;   ///< some of the poses are far off
  float turned = 0.0F;     ///< turn of all poses away from the truth
  float shifted_x = 0.0F;  ///< and their shift, cells
  float shifted_y = 0.0F;
  std::uint32_t counted = 0;  ///< cap of the values, below that of the field; 0: the same
  bool strips = false;        ///< the field lies in strips

  [[nodiscard]] std::string name() const {
    std::string text = size_name(field) + (room ? " room " : " slow ") + std::to_string(poses) + " poses " +
                       std::to_string(points) + " points cap " + std::to_string(cap);
    text += prior == DescentPriorKind::kWeak ? " weak prior" : prior == DescentPriorKind::kSteep ? " steep prior" : "";
    return text + " limit " + std::to_string(max_evaluations) + (strips ? " strips" : "");
  }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

PriorParams make_prior(DescentPriorKind kind, std::uint32_t points) {
  PriorParams prior{.mean_x = 2.0F, .mean_y = -1.0F, .mean_theta = 0.28F};
  if (kind == DescentPriorKind::kWeak) {
    prior.weight_xy = 20.0F * static_cast<float>(points);
    prior.weight_theta = 80000.0F * static_cast<float>(points);
  } else if (kind == DescentPriorKind::kSteep) {
    prior.weight_xy = 3.0e7F;
    prior.weight_theta = 3.0e36F;
  } else if (kind == DescentPriorKind::kFaint) {
    prior.weight_xy = prior.weight_theta = 5.5e-21F;
  } else if (kind == DescentPriorKind::kSteepTurn) {
    prior.weight_xy = 40.0F;
    prior.weight_theta = 3.0e36F;
  }
  return prior;
}

/// Poses near the truth; one lies on whole cells without rotation, one off the map, one farther off than any map.
std::vector<PolishedPose> make_poses(const DescentCase& shape, Random& random) {
  std::vector<PolishedPose> poses(shape.poses);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i] = {around(kTruePose.x + shape.shifted_x, 4.0, random), around(kTruePose.y + shape.shifted_y, 4.0, random),
                around(kTruePose.theta + shape.turned, 0.1, random)};
    if (shape.odd_poses && i % 8 == 3) {
      poses[i] = {2.0F, -1.0F, 0.0F};
    } else if (shape.odd_poses && i % 8 == 5) {
      poses[i] = {-1.0e9F, 3.0e18F, 60.0F};
    } else if (shape.odd_poses && i % 8 == 6) {
      poses[i] = {4000.0F, -500.0F, -3.0F};
    }
    poses[i].cost = draw_word(random);
    poses[i].evaluations = i % 4 == 1 ? 0xFFFFFFF0U : static_cast<std::uint32_t>(random.below(1000));
    poses[i].stop = static_cast<std::uint32_t>(random.below(3));
    poses[i].reserved[0] = draw_word(random);
    poses[i].reserved[1] = draw_word(random);
  }
  return poses;
}

KernelCase DescentCase::make(const std::string& named) const {
  Random random(seed_from(named));
  PoseDescent::Params params{
      .grid = cost_params(field, points, counted == 0 ? cap : counted, Interpolation::kBilinear, CostForm::kDistance),
      .prior = make_prior(prior, points),
      .width = width,
      .narrowing = narrowing,
      .last_width = last_width,
      .stop_cells = stop_cells,
      .stop_rad = stop_rad,
      .max_evaluations = max_evaluations};
  auto buffers = scene_buffers(field, room, cap, points, random);
  if (strips) lay_in_strips(field, cap, params.grid, buffers[0]);
  buffers.push_back(words_buffer(make_poses(*this, random)));
  buffers.push_back(noise_buffer(poses * PoseDescent::row_of(points) / 2, random));
  return make_case<PoseDescent>(named, params, {poses, 1, 1}, std::move(buffers));
}

// Numbers of points and poses around the lanes of a group, with and without a shape to find.
void add_sizes(std::vector<KernelCaseSource>& list) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kCounts[] = {{0, 2},  {1, 1},   {7, 9},    {63, 1},  {64, 2},
                                                                 {65, 5}, {180, 8}, {361, 17}, {2101, 3}};
  for (const auto& [points, poses] : kCounts) {
    const DescentCase shape{.points = points, .poses = poses, .prior = DescentPriorKind::kWeak};
    add_case(list, shape);
    DescentCase in_strips = shape;
    in_strips.strips = true;
    add_case(list, in_strips);
    DescentCase slow = shape;
    slow.field = {97, 83, 100};
    slow.room = false;
    slow.prior = DescentPriorKind::kNone;
    add_case(list, slow);
  }
  add_case(list, DescentCase{.poses = 0});
  add_case(list, DescentCase{.field = {2, 2, 4}, .points = 9});
  add_case(list, DescentCase{.field = {5, 5, 8}, .room = false, .points = 50});
  for (const std::uint32_t limit : {0U, 9U, PoseDescent::kMostEvaluations}) {
    add_case(list, DescentCase{.points = 65535,
                               .poses = 2,
                               .cap = 65535,
                               .prior = DescentPriorKind::kSteep,
                               .max_evaluations = limit,
                               .stop_cells = 0.0F,
                               .stop_rad = 0.0F});
  }
}

// At angles of every quarter turn, and at angles that were not wrapped.
void add_turns(std::vector<KernelCaseSource>& list) {
  for (const float turned : {1.1F, 2.7F, -1.6F, -2.9F, 9.7F, -40.3F}) {
    add_case(list, DescentCase{.room = false, .points = 61, .poses = 2, .odd_poses = false, .turned = turned},
             ", turned " + std::to_string(turned));
  }
}

// Half of the points beyond each edge of the field, values beyond a cap, and curvatures that are singular or almost so.
void add_edges(std::vector<KernelCaseSource>& list) {
  DescentCase edge{.field = {97, 83, 100}, .room = false, .points = 61, .odd_poses = false};
  for (const auto& [x, y] : {std::pair(52.0F, 0.0F), {-44.0F, 0.0F}, {0.0F, 48.0F}, {0.0F, -36.0F}}) {
    edge.shifted_x = x;
    edge.shifted_y = y;
    add_case(list, edge, ", at the edge " + std::to_string(x) + " " + std::to_string(y));
  }
  add_case(list, DescentCase{.counted = 700}, ", values up to 700");
  add_case(list, DescentCase{.points = 0, .prior = DescentPriorKind::kFaint}, ", faint prior");
  add_case(list, DescentCase{.points = 0, .prior = DescentPriorKind::kSteepTurn}, ", prior steep in theta");
}

void add_gates(std::vector<KernelCaseSource>& list) {
  for (std::uint32_t limit = 0; limit < 14; ++limit) add_case(list, DescentCase{.poses = 5, .max_evaluations = limit});
  add_case(list, DescentCase{.points = 361, .poses = 7, .cap = 65535, .prior = DescentPriorKind::kSteep});
  add_case(list, DescentCase{.points = 361, .poses = 7});
  add_case(list, DescentCase{.poses = 7, .width = 0.001F, .last_width = 0.001F}, ", no point counts");
  add_case(list, DescentCase{.poses = 7, .width = 200.0F, .last_width = 900.0F}, ", first gate below the last");
  add_case(list, DescentCase{.poses = 7, .width = 1.0e6F, .narrowing = 0.9F, .last_width = 10.0F}, ", many gates");
  add_case(list, DescentCase{.poses = 7, .narrowing = 0.0F}, ", at once the last gate");
  add_case(list, DescentCase{.stop_cells = 3.0e37F, .stop_rad = 3.0e37F}, ", any step is small");
  add_case(list, DescentCase{.stop_cells = 0.0F}, ", no step in x and y is small");
  add_case(list, DescentCase{.stop_rad = 0.0F}, ", no step in theta is small");
}

void add_descents(std::vector<KernelCaseSource>& list) {
  add_sizes(list);
  add_turns(list);
  add_edges(list);
  add_gates(list);
  // So many gates that each runs to its limit: rates count the actual look-ups.
  add_case(list,
           DescentCase{.field = {1024, 1024, 1024},
                       .points = 180,
                       .poses = 64,
                       .prior = DescentPriorKind::kWeak,
                       .width = 1.0e6F,
                       .narrowing = 0.9F,
                       .last_width = 10.0F,
                       .odd_poses = false},
           ", to the limit", CaseUse::kBenchmark);
}

KernelCase draw_descent(const std::string& name, Random& random) {
  DescentCase shape;
  shape.field = draw_size(random, 2);
  shape.room = random.below(2) == 0;
  shape.points = draw_count(random, 400);
  shape.poses = draw_count(random, 9);
  shape.cap = random.below(2) == 0 ? 5120 : draw_count(random, 65535);
  shape.prior = static_cast<DescentPriorKind>(random.below(3));
  shape.max_evaluations = static_cast<std::uint32_t>(random.below(PoseDescent::kMostEvaluations + 1));
  shape.width = static_cast<float>(random.uniform(1.0, 20000.0));
  shape.narrowing = static_cast<float>(random.uniform(0.0, 0.9));
  shape.last_width = static_cast<float>(random.uniform(1.0, 5000.0));
  shape.stop_cells = static_cast<float>(random.uniform(0.0, 0.1));
  shape.stop_rad = static_cast<float>(random.uniform(0.0, 0.002));
  shape.odd_poses = random.below(4) == 0;
  return shape.make(name);
}

}  // namespace

CaseGroup PoseDescent::cases() { return {add_descents, {{&PoseDescent::info(), draw_descent}}}; }

}  // namespace gdtslam
