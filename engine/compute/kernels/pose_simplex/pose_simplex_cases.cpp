#include "pose_simplex.hpp"

#include "engine/compute/cases/case_builder.hpp"
#include "engine/compute/cases/scan_data.hpp"

namespace gdtslam {
namespace {

float around(float middle, double spread, Random& random) {
  return middle + static_cast<float>(random.uniform(-spread, spread));
}

struct StartsCase {
  using Kernel = PoseStarts;
  std::uint32_t starts;
  std::uint32_t candidates;
  [[nodiscard]] std::string name() const { return std::to_string(starts) + " starts of " + std::to_string(candidates); }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

KernelCase StartsCase::make(const std::string& named) const {
  Random random(seed_from(named));
  std::vector<PoseCandidate> poses(candidates);
  for (PoseCandidate& pose : poses) {
    pose = {around(0, 9, random), around(0, 9, random), around(0, 3, random), draw_word(random)};
  }
  std::vector<std::uint32_t> picks;
  for (std::uint32_t i = 0; i + 1 < starts; ++i) {
    const std::uint32_t odd[] = {kNoCost, candidates, candidates - 1, 0, 0x80000000U};
    const auto any = static_cast<std::uint32_t>(random.below(std::uint64_t{candidates} + 1));
    picks.insert(picks.end(), {draw_word(random), i % 2 == 0 ? any : odd[i / 2 % 5]});
  }
  return make_case<PoseStarts>(named, {.x = 1.5F, .y = -0.0F, .theta = -3.0F, .candidate_count = candidates},
                               {starts, 1, 1},
                               {list_buffer(poses), list_buffer(picks), noise_buffer(8 * starts, random)});
}

/// Priors: none, one with about the weight of the points, one at its limit everywhere except near the mean.
enum class DescentPriorKind : std::uint8_t { kNone, kWeak, kSteep };

/// Parameters that the cases of pose_simplex vary.
struct DescentCase {
  using Kernel = PoseSimplex;
  CaseSize field{256, 200, 256};
  bool room = true;  ///< else a field without any shape
  std::uint32_t points = 180;
  std::uint32_t poses = 3;
  std::uint32_t cap = 20 * 256;
  Interpolation interpolation = Interpolation::kBilinear;
  CostForm form = CostForm::kDistance;
  DescentPriorKind prior = DescentPriorKind::kNone;
  std::uint32_t max_evaluations = 200;
  float step_cells = 2.0F;
  float step_rad = 0.03F;
  float stop_cells = 0.01F;
  float stop_rad = 0.0002F;
  bool odd_poses = true;  ///< some of the poses are far off
  float turned = 0.0F;    ///< turn of all poses away from the truth
  bool strips = false;    ///< the field lies in strips

  [[nodiscard]] std::string name() const {
    std::string text = size_name(field) + (room ? " room " : " slow ") + std::to_string(poses) + " poses " +
                       std::to_string(points) + " points cap " + std::to_string(cap);
    text += interpolation == Interpolation::kNearest ? " nearest" : " bilinear";
    text += form == CostForm::kSquared ? " squared" : "";
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
    prior.weight_theta = 3.0e38F;
  }
  return prior;
}

/// Poses near the truth; one lies on whole cells without rotation, one off the map, one farther off than any map.
std::vector<PolishedPose> make_poses(std::uint32_t count, bool odd, float turned, Random& random) {
  std::vector<PolishedPose> poses(count);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i] = {around(kTruePose.x, 4.0, random), around(kTruePose.y, 4.0, random),
                around(kTruePose.theta + turned, 0.1, random)};
    if (odd && i % 8 == 3) {
      poses[i] = {2.0F, -1.0F, 0.0F};
    } else if (odd && i % 8 == 5) {
      poses[i] = {-1.0e9F, 3.0e30F, 60.0F};
    } else if (odd && i % 8 == 6) {
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
  PoseSimplex::Params params{.cost = cost_params(field, points, cap, interpolation, form),
                             .prior = make_prior(prior, points),
                             .step_cells = step_cells,
                             .step_rad = step_rad,
                             .stop_cells = stop_cells,
                             .stop_rad = stop_rad,
                             .max_evaluations = max_evaluations};
  auto buffers = scene_buffers(field, room, cap, points, random);
  if (strips) {
    lay_in_strips(field, cap, params.cost, buffers[0]);
  }
  buffers.push_back(words_buffer(make_poses(poses, odd_poses, turned, random)));
  return make_case<PoseSimplex>(named, params, {poses, 1, 1}, std::move(buffers));
}

// Numbers of points and poses around the sizes of work groups, with and without a shape to find.
void add_descents(std::vector<KernelCaseSource>& list, Interpolation interpolation, CostForm form) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kCounts[] = {{0, 2},  {1, 1},   {7, 9},   {16, 1},
                                                                 {17, 5}, {180, 8}, {361, 17}};
  for (const auto& [points, poses] : kCounts) {
    const DescentCase shape{.points = points,
                            .poses = poses,
                            .interpolation = interpolation,
                            .form = form,
                            .prior = DescentPriorKind::kWeak};
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
  // More points than a uniform buffer holds, and few enough evaluations for an invocation a pose.
  add_case(list, DescentCase{.points = 2101,
                             .poses = 3,
                             .interpolation = interpolation,
                             .form = form,
                             .prior = DescentPriorKind::kWeak,
                             .max_evaluations = 60});
  add_case(list, DescentCase{.field = {2, 2, 4}, .points = 9, .interpolation = interpolation, .form = form});
  add_case(list,
           DescentCase{.field = {5, 5, 8}, .room = false, .points = 50, .interpolation = interpolation, .form = form});
}

// At angles of every quarter turn, and at angles that were not wrapped; few points, and more than a uniform buffer
// holds.
void add_turned_descents(std::vector<KernelCaseSource>& list) {
  std::uint32_t turn = 0;
  for (const float turned : {1.1F, 2.7F, -1.6F, -2.9F, 9.7F, -40.3F}) {
    for (const std::uint32_t points : {61U, 2099U}) {
      add_case(list,
               DescentCase{.room = false,
                           .points = points,
                           .poses = 2,
                           .interpolation = turn++ % 2 == 0 ? Interpolation::kBilinear : Interpolation::kNearest,
                           .max_evaluations = 60,
                           .odd_poses = false,
                           .turned = turned},
               ", turned " + std::to_string(turned));
    }
    ++turn;  // so that either number of points meets either interpolation
  }
  for (const std::uint32_t points : {61U, 2099U}) {
    add_case(
        list,
        DescentCase{.room = false, .points = points, .cap = 200, .form = CostForm::kSquared, .max_evaluations = 60},
        ", squares of 16 bits");
  }
}

// Descents with so many evaluations that a device that ends loops by itself would cut them short.
void add_longest_descents(std::vector<KernelCaseSource>& list) {
  add_case(list, DescentCase{.points = 17, .poses = 5, .max_evaluations = PoseSimplex::kMostEvaluations});
  add_case(list,
           DescentCase{.poses = 2, .max_evaluations = 4000, .stop_cells = 0.0F, .stop_rad = 0.0F, .odd_poses = false},
           ", to the limit");
  add_case(list,
           DescentCase{.points = 65537,
                       .poses = 2,
                       .cap = 65535,
                       .max_evaluations = 150,
                       .stop_cells = 0.0F,
                       .stop_rad = 0.0F,
                       .odd_poses = false},
           ", to the limit");
}

void add_descents_with_odd_sizes(std::vector<KernelCaseSource>& list) {
  // The fourth start lies on whole cells: its edges are halved without rounding and reach exactly these sizes.
  add_case(list, DescentCase{.points = 0, .poses = 4, .stop_cells = 0x1p-7F, .stop_rad = 1.0F},
           ", size in x and y met");
  add_case(list, DescentCase{.points = 0, .poses = 4, .stop_cells = 9.0F, .stop_rad = 0.03F * 0x1p-8F},
           ", size in theta met");
  add_case(list, DescentCase{.step_cells = 0.0F, .step_rad = 0.0F}, ", no steps");
  add_case(list, DescentCase{.step_cells = -3.0F, .step_rad = -0.1F}, ", steps backwards");
  add_case(list, DescentCase{.stop_cells = 3.0e38F, .stop_rad = 3.0e38F}, ", any size is small");
  add_case(list, DescentCase{.max_evaluations = 90, .stop_cells = 0.0F}, ", no size in x and y is small");
  add_case(list, DescentCase{.max_evaluations = 90, .stop_rad = 0.0F}, ", no size in theta is small");
}

// Without a size to stop at, each runs to its limit, and rates count the actual look-ups.
void add_benchmark_descents(std::vector<KernelCaseSource>& list) {
  for (const Interpolation interpolation : {Interpolation::kBilinear, Interpolation::kNearest}) {
    add_case(list,
             DescentCase{.field = {1024, 1024, 1024},
                         .points = 361,
                         .poses = 8,
                         .interpolation = interpolation,
                         .prior = DescentPriorKind::kWeak,
                         .max_evaluations = 100,
                         .stop_cells = 0.0F,
                         .stop_rad = 0.0F,
                         .odd_poses = false},
             ", to the limit", CaseUse::kBenchmark);
  }
}

void add_descents(std::vector<KernelCaseSource>& list) {
  for (const Interpolation interpolation : {Interpolation::kBilinear, Interpolation::kNearest}) {
    for (const CostForm form : {CostForm::kDistance, CostForm::kSquared}) add_descents(list, interpolation, form);
  }
  add_turned_descents(list);
  add_case(list, DescentCase{.poses = 0});
  add_case(list, DescentCase{.points = 361, .poses = 7, .cap = 65535, .prior = DescentPriorKind::kSteep});
  add_case(list, DescentCase{.points = 361, .poses = 7});
  add_case(
      list,
      DescentCase{.points = 65537, .poses = 7, .cap = 65535, .prior = DescentPriorKind::kSteep, .max_evaluations = 9});
  add_case(
      list,
      DescentCase{.points = 65537, .poses = 7, .cap = 65535, .prior = DescentPriorKind::kSteep, .max_evaluations = 0});
  for (std::uint32_t limit = 0; limit < 14; ++limit) {
    add_case(list, DescentCase{.poses = 5, .max_evaluations = limit});
  }
  add_longest_descents(list);
  add_descents_with_odd_sizes(list);
  add_benchmark_descents(list);
}

KernelCase draw_starts(const std::string& name, Random& random) {
  const auto starts = static_cast<std::uint32_t>(random.below(SmallestValues::kMost + 2));
  return StartsCase{starts, draw_count(random, 3000)}.make(name);
}

KernelCase draw_descent(const std::string& name, Random& random) {
  DescentCase shape;
  shape.field = draw_size(random, 2);
  shape.room = random.below(2) == 0;
  shape.points = draw_count(random, 400);
  shape.poses = draw_count(random, 9);
  shape.cap = random.below(2) == 0 ? 5120 : draw_count(random, 65535);
  shape.interpolation = random.below(2) == 0 ? Interpolation::kBilinear : Interpolation::kNearest;
  shape.form = random.below(2) == 0 ? CostForm::kDistance : CostForm::kSquared;
  shape.prior = static_cast<DescentPriorKind>(random.below(3));
  shape.max_evaluations = draw_count(random, 200);
  shape.step_cells = around(0.0F, 4.0, random);
  shape.step_rad = around(0.0F, 0.1, random);
  shape.stop_cells = static_cast<float>(random.uniform(0.0, 0.1));
  shape.stop_rad = static_cast<float>(random.uniform(0.0, 0.002));
  shape.odd_poses = random.below(4) == 0;
  return shape.make(name);
}

void add_pose_simplex_cases(std::vector<KernelCaseSource>& list) {
  for (std::uint32_t starts = 0; starts <= SmallestValues::kMost + 1; ++starts) {
    add_case(list, StartsCase{starts, 100});
  }
  add_case(list, StartsCase{17, 1});
  add_case(list, StartsCase{3, 0});
  add_case(list, StartsCase{17, 1U << 17U}, CaseUse::kBenchmark);
  add_descents(list);
}

}  // namespace

CaseGroup PoseStarts::cases() {
  return {add_pose_simplex_cases, {{&PoseStarts::info(), draw_starts}, {&PoseSimplex::info(), draw_descent}}};
}

}  // namespace gdtslam
