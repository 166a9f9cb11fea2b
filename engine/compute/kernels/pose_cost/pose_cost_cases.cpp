#include <limits>

#include "engine/compute/cases/case_builder.hpp"
#include "engine/compute/cases/scan_data.hpp"
#include "pose_cost.hpp"

namespace gdtslam {
namespace {

/// Parameters that the cases of pose_cost vary.
struct CostCase {
  using Kernel = PoseCost;
  CaseSize field;
  std::uint32_t points = 0;
  std::uint32_t candidates = 0;
  std::uint32_t cap = 0;
  double spread_cells = 0.0;  ///< largest distance of a candidate from the anchor, along x and y
  Interpolation interpolation = Interpolation::kBilinear;
  CostForm form = CostForm::kDistance;
  std::int32_t anchor_shift = 0;  ///< shift of the anchor, out of the field's middle
  bool odd_points = false;        ///< some points are NaN, infinite or far off
  std::uint32_t field_cap = 0;    ///< value of unknown cells; 0: the cap
  bool is_subnormal = false;      ///< many coordinates of points and poses are subnormal
  bool strips = false;            ///< the field lies in strips, and its cap is 0
  std::uint32_t row = 1;          ///< so many candidates differ in x alone,
  float row_step_cells = 0.0F;    ///< by as much from one to the next

  [[nodiscard]] std::string name() const {
    return size_name(field) + " " + std::to_string(candidates) + " poses " + std::to_string(points) + " points cap " +
           std::to_string(cap) + (interpolation == Interpolation::kBilinear ? " bilinear" : " nearest") +
           (form == CostForm::kSquared ? " squared" : "") + (field_cap != 0 ? " of " + std::to_string(field_cap) : "") +
           (anchor_shift != 0 ? " anchor " + std::to_string(anchor_shift) : "") + (odd_points ? " odd" : "") +
           (is_subnormal ? " subnormal" : "") + (strips ? " strips" : "") +
           (row > 1 ? " rows of " + std::to_string(row) + " every " + std::to_string(row_step_cells) : "");
  }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

/// Replaces every second point by one that is NaN, infinite, huge or at the limits of the clamp.
void spoil(std::vector<PointCells>& points) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr PointCells kOdd[] = {{kNaN, 0.0F},       {1.0F, kNaN},        {kInfinity, 2.0F},
                                 {0.0F, -kInfinity}, {3.0e38F, 1.0F},     {1.0F, -3.0e38F},
                                 {4194304.0F, 0.0F}, {0.0F, -4194304.0F}, {4194303.5F, 9.0F}};
  for (std::size_t i = 1; i < points.size(); i += 2) {
    points[i] = kOdd[i / 2 % std::size(kOdd)];
  }
}

/// Makes x subnormal in two of three points, and y in one of three.
void make_subnormal(std::vector<PointCells>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % 3 > 0) {
      points[i].x = i % 2 == 0 ? kSubnormal : -kSubnormal;
    }
    if (i % 3 > 1) {
      points[i].y = i % 4 < 2 ? kSubnormal : -3.0F * kSubnormal;
    }
  }
}

/// Poses around the anchor; one lies on whole cells without rotation, one far off, one has a bias that saturates.
std::vector<PoseCandidate> make_candidates(const CostCase& shape, Random& random) {
  std::vector<PoseCandidate> poses(shape.candidates);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].x = static_cast<float>(shape.spread_cells * random.uniform(-1.0, 1.0));
    poses[i].y = static_cast<float>(shape.spread_cells * random.uniform(-1.0, 1.0));
    poses[i].theta = static_cast<float>(random.uniform(-3.2, 3.2));
    poses[i].bias = static_cast<std::uint32_t>(random.below(1000));
    if (i % 16 == 3) {
      poses[i] = {2.0F, -1.0F, 0.0F, 0};
    } else if (i % 16 == 5) {
      poses[i] = {-1.0e9F, 3.0e30F, 60.0F, 1};
    } else if (i % 16 == 7) {
      poses[i].bias = 0xFFFFFFFFU;
    }
    if (i % shape.row != 0) {
      const PoseCandidate& before = poses[i - 1];
      poses[i] = {before.x + shape.row_step_cells, before.y, before.theta, poses[i].bias};
    }
  }
  return poses;
}

KernelCase CostCase::make(const std::string& named) const {
  Random random(seed_from(named));
  PoseCost::Params params = cost_params(field, points, cap, interpolation, form);
  params.anchor_x += anchor_shift;
  params.anchor_y -= anchor_shift;
  const std::vector<std::uint16_t> cells = slow_field(field, field_cap != 0 ? field_cap : cap, random);
  std::vector<PointCells> scan = scattered_points(field, points, random);
  if (odd_points) {
    spoil(scan);
  }
  std::vector<PoseCandidate> poses = make_candidates(*this, random);
  if (is_subnormal) {
    make_subnormal(scan);
    make_subnormal(poses);
  }
  CaseBuffer map = grid_buffer(field, cells);
  if (strips) {
    lay_in_strips(field, field_cap != 0 ? field_cap : cap, params, map);
  }
  return make_case<PoseCost>(named, params, {candidates, 1, 1},
                             {map, list_buffer(scan), list_buffer(poses), noise_buffer(candidates, random)});
}

constexpr Interpolation kInterpolations[] = {Interpolation::kBilinear, Interpolation::kNearest};
constexpr CostForm kForms[] = {CostForm::kDistance, CostForm::kSquared};
constexpr CaseSize kBenchField{1024, 1024, 1024};

void add_costs(std::vector<KernelCaseSource>& list, Interpolation interpolation, CostForm form) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kCounts[] = {{0, 3},  {1, 1},   {7, 4},   {15, 8},  {16, 1},
                                                                 {17, 5}, {33, 17}, {180, 3}, {361, 70}};
  for (const auto& [points, candidates] : kCounts) {
    add_case(list, CostCase{{97, 83, 100}, points, candidates, 20 * 256, 60.0, interpolation, form});
    add_case(list, CostCase{{256, 200, 256}, points, candidates, 65535, 20.0, interpolation, form});
  }
  for (const CaseSize& size : {CaseSize{97, 83, 100}, {256, 200, 256}, {64, 70, 64}, {66, 3, 68}, {129, 64, 132}}) {
    for (const std::uint32_t points : {17U, 361U}) {
      add_case(list, CostCase{.field = size,
                              .points = points,
                              .candidates = 33,
                              .cap = 5120,
                              .spread_cells = 60.0,
                              .interpolation = interpolation,
                              .form = form,
                              .strips = true});
    }
  }
  // Rows shorter and longer than a vector, within and beyond 30 cells, across strips and edges, back and forth.
  for (const auto& [row, step] :
       {std::pair(4U, 1.0F), {5U, 7.5F}, {16U, 2.0F}, {17U, 0.37F}, {23U, 6.0F}, {9U, -1.0F}}) {
    for (const CaseSize& size : {CaseSize{97, 83, 100}, {256, 200, 256}, {64, 70, 64}, {66, 3, 68}, {2, 2, 4}}) {
      add_case(list, CostCase{.field = size,
                              .points = 133,
                              .candidates = 6 * row,
                              .cap = 5120,
                              .spread_cells = 60.0,
                              .interpolation = interpolation,
                              .form = form,
                              .odd_points = row == 17,
                              .strips = row != 5,
                              .row = row,
                              .row_step_cells = step});
    }
  }
  add_case(list, CostCase{{2, 2, 4}, 9, 6, 1000, 3.0, interpolation, form});
  add_case(list, CostCase{{5, 5, 8}, 50, 20, 255, 3.0, interpolation, form});
  add_case(list, CostCase{{64, 64, 64}, 65537, 2, 65535, 300.0, interpolation, form});
  add_case(list, CostCase{{97, 83, 100}, 40, 17, 5120, 60.0, interpolation, form, 0, true});
  add_case(list, CostCase{{97, 83, 100}, 33, 17, 700, 60.0, interpolation, form, 0, false, 5120});
  add_case(list,
           CostCase{{97, 83, 100}, 2101, 40, 5120, 60.0, interpolation, form});  // more than a uniform buffer holds
  add_case(list, CostCase{.field = {97, 83, 100},
                          .points = 40,
                          .candidates = 70,
                          .cap = 5120,
                          .spread_cells = 30.0,
                          .interpolation = interpolation,
                          .form = form,
                          .is_subnormal = true});
  for (const std::int32_t shift : {-(1 << 20), 1 << 20}) {
    add_case(list, CostCase{{97, 83, 100}, 9, 5, 5120, 60.0, interpolation, form, shift});
  }
}

KernelCase draw_cost(const std::string& name, Random& random) {
  CostCase shape{.field = draw_size(random, 2)};
  shape.points = draw_count(random, 500);
  shape.candidates = draw_count(random, 60);
  shape.cap = random.below(2) == 0 ? 5120 : draw_count(random, 65535);
  shape.spread_cells = random.uniform(0.0, 100.0);
  shape.interpolation = draw_from(random, kInterpolations);
  shape.form = draw_from(random, kForms);
  shape.anchor_shift = static_cast<std::int32_t>(draw_count(random, 1000)) - 20;
  shape.odd_points = random.below(8) == 0;
  shape.strips = random.below(2) == 0;
  shape.row = 1 + draw_count(random, 40);
  shape.row_step_cells = static_cast<float>(random.uniform(-1.0, 8.0));
  return shape.make(name);
}

void add_pose_cost_cases(std::vector<KernelCaseSource>& list) {
  for (const Interpolation interpolation : kInterpolations) {
    for (const CostForm form : kForms) {
      add_costs(list, interpolation, form);
    }
  }
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    if (size.width >= 2 && size.height >= 2) {
      const std::uint32_t cap = turn % 5 == 0 ? 65535 : 5120;
      add_case(list, CostCase{size, turn % 41, turn % 6, cap, 9.0, in_turn(kInterpolations, turn),
                              in_turn(kForms, turn / 2)});
    }
  });
  for (const CaseSize& size : kLargeSizes) {
    add_case(list, CostCase{size, 361, 20000, 5120, 900.0}, CaseUse::kLarge);
  }
  // Enough candidates to fill a GPU with one invocation each.
  for (const Interpolation interpolation : kInterpolations) {
    for (const std::uint32_t points : {9U, 2053U}) {
      add_case(list, CostCase{{97, 83, 100}, points, 16387, 5120, 60.0, interpolation, CostForm::kDistance});
    }
    add_case(list, CostCase{{97, 83, 100}, 9, 16387, 5120, 60.0, interpolation, CostForm::kSquared});
    for (const auto& [points, candidates] : {std::pair{9U, 16387U}, std::pair{2101U, 40U}, std::pair{9U, 40U}}) {
      add_case(list,
               CostCase{{97, 83, 100}, points, candidates, 200, 60.0, interpolation, CostForm::kSquared});  // 16 bits
    }
  }
  for (const Interpolation interpolation : kInterpolations) {
    CostCase shape{.field = kBenchField,
                   .points = 361,
                   .candidates = 4096,
                   .cap = 20 * 256,
                   .spread_cells = 40.0,
                   .interpolation = interpolation};
    add_case(list, shape, CaseUse::kBenchmark);
    shape.strips = true;
    add_case(list, shape, CaseUse::kBenchmark);
    shape.row = 32;
    shape.row_step_cells = 0.5F;
    add_case(list, shape, CaseUse::kBenchmark);
  }
  add_case(list, CostCase{kBenchField, 361, 4096, 20 * 256, 40.0, Interpolation::kBilinear, CostForm::kSquared},
           CaseUse::kBenchmark);
  add_case(list, CostCase{kBenchField, 180, 2, 20 * 256, 4.0, Interpolation::kBilinear, CostForm::kDistance},
           CaseUse::kBenchmark);
}

}  // namespace

CaseGroup PoseCost::cases() { return {add_pose_cost_cases, {{&PoseCost::info(), draw_cost}}}; }

}  // namespace gdtslam
