#include <functional>
#include <limits>

#include "engine/compute/cases/case_builder.hpp"
#include "engine/compute/cases/scan_data.hpp"
#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"

namespace gdtslam {
namespace {

using Poses = std::vector<PolishedPose>;

/// Parameters that the cases of choose_pose vary.
struct ChoiceCase {
  using Kernel = ChoosePose;
  CaseSize field{256, 200, 256};
  bool room = true;    ///< else a field without any shape
  bool steps = false;  ///< the field in whole cells, so that values meet limits
  bool strips = false;
  std::uint32_t points = 180;
  std::uint32_t poses = 5;
  std::uint32_t map_cap = 20 * 256;
  std::uint32_t wide = 10 * 256;
  Interpolation interpolation = Interpolation::kBilinear;
  CostForm form = CostForm::kDistance;
  /// Makes the change that the case is named after.
  std::function<void(ChoosePose::Params&, Poses&)> change = [](ChoosePose::Params&, Poses&) {};

  [[nodiscard]] std::string name() const {
    return size_name(field) + (room ? " room " : " slow ") + (steps ? "steps " : "") + (strips ? "strips " : "") +
           std::to_string(poses) + " poses " + std::to_string(points) + " points caps " + std::to_string(map_cap) +
           " " + std::to_string(wide) + (interpolation == Interpolation::kNearest ? " nearest" : " bilinear") +
           (form == CostForm::kSquared ? " squared" : "");
  }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

PolishedPose pose_at(float x, float y, float theta) {
  PolishedPose pose;
  pose.x = x;
  pose.y = y;
  pose.theta = theta;
  return pose;
}

/// Poses around the true one, the third the true one itself; all members except the coordinates are noise.
Poses make_poses(std::uint32_t count, Random& random) {
  Poses poses;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto near = [&](float middle, double spread) {
      return middle + static_cast<float>(i == 2 ? 0.0 : random.uniform(-spread, spread));
    };
    poses.push_back(pose_at(near(kTruePose.x, 3.0), near(kTruePose.y, 3.0), near(kTruePose.theta, 0.1)));
    for (std::uint32_t* member : {&poses.back().cost, &poses.back().evaluations, &poses.back().stop,
                                  &poses.back().reserved[0], &poses.back().reserved[1]}) {
      *member = draw_word(random);
    }
  }
  return poses;
}

/// Rounds a field's values down to whole cells.
void cut_to_cells(CaseBuffer& field) {
  std::vector<std::uint16_t> values(field.content.size() / 2);
  std::memcpy(values.data(), field.content.data(), field.content.size());
  for (std::uint16_t& value : values) {
    value = static_cast<std::uint16_t>(value / 256 * 256);
  }
  std::memcpy(field.content.data(), values.data(), field.content.size());
}

KernelCase ChoiceCase::make(const std::string& named) const {
  Random random(seed_from(named));
  ChoosePose::Params params{
      .cost = cost_params(field, points, wide, interpolation, form),
      .prior = {.mean_x = 2.0F, .mean_y = -1.0F, .mean_theta = 0.28F, .weight_xy = 900.0F, .weight_theta = 4.0e5F},
      .map_cap = map_cap,
      .gate = 256,
      .contradiction_q16 = 65536,
      .overlap_q16 = 0,
      .leap_q8 = 0,
      .far_sq_cells = 4.0F,
      .far_rad = 0.05F};
  Poses tried = make_poses(poses, random);
  change(params, tried);
  params.pose_count = static_cast<std::uint32_t>(tried.size());
  auto buffers = scene_buffers(field, room, map_cap, points, random);
  if (steps) {
    cut_to_cells(buffers[0]);
  }
  if (strips) {
    lay_in_strips(field, map_cap, params.cost, buffers[0]);
  }
  buffers.push_back(words_buffer(tried));
  constexpr auto kWords = static_cast<std::uint32_t>(sizeof(MatchVerdict) / 4);
  buffers.push_back(noise_buffer(kWords, random));
  return make_case<ChoosePose>(named, params, {1, 1, 1}, std::move(buffers));
}

template <class Change>
void add_choice(std::vector<KernelCaseSource>& list, ChoiceCase shape, const std::string& what, Change change) {
  shape.change = change;
  add_case(list, shape, what);
}

void add_sizes(std::vector<KernelCaseSource>& list) {
  for (const Interpolation interpolation : {Interpolation::kBilinear, Interpolation::kNearest}) {
    for (const CostForm form : {CostForm::kDistance, CostForm::kSquared}) {
      for (const std::uint32_t points : {0U, 1U, 15U, 16U, 17U, 180U, 361U}) {
        ChoiceCase shape{.points = points, .interpolation = interpolation, .form = form};
        add_case(list, shape);
        shape.strips = true;
        add_case(list, shape);
        shape.room = false;
        shape.poses = 1 + points % 17;
        add_case(list, shape);
      }
      add_case(list, ChoiceCase{.field = {2, 2, 4}, .interpolation = interpolation, .form = form});
      add_case(list, ChoiceCase{.field = {7, 9, 8}, .room = false, .interpolation = interpolation, .form = form});
    }
  }
  add_case(list, ChoiceCase{.wide = 200, .form = CostForm::kSquared}, ", squares of 16 bits");
  for (std::uint32_t poses = 1; poses <= SmallestValues::kMost + 1; ++poses) {
    add_case(list, ChoiceCase{.points = 33, .poses = poses});
  }
}

// One pose at an angle in every quarter turn, and at angles that were not wrapped: only the chosen pose is written, so
// each case tests one angle.
void add_angles(std::vector<KernelCaseSource>& list) {
  std::uint32_t turn = 0;
  for (const float theta : {1.0F, 2.0F, 3.1F, -1.2F, -2.5F, -3.14F, 1.5707964F, 10.0F, -30.0F, 63.9F}) {
    const ChoiceCase shape{.room = false,
                           .poses = 1,
                           .interpolation = turn++ % 2 == 0 ? Interpolation::kBilinear : Interpolation::kNearest};
    add_choice(list, shape, ", angle " + std::to_string(theta),
               [theta](ChoosePose::Params&, Poses& poses) { poses.front().theta = theta; });
  }
}

// Voters: all, those over known cells, none.
void add_voters(std::vector<KernelCaseSource>& list) {
  for (const bool room : {true, false}) {
    const ChoiceCase shape{.room = room};
    add_choice(list, shape, ", low overlap", [](ChoosePose::Params& p, Poses&) { p.overlap_q16 = 65536; });
    add_choice(list, shape, ", contradiction", [](ChoosePose::Params& p, Poses&) { p.contradiction_q16 = 0; });
    add_choice(list, shape, ", half of each", [](ChoosePose::Params& p, Poses&) {
      p.overlap_q16 = 32768;
      p.contradiction_q16 = 32768;
    });
  }
  add_choice(list, {}, ", gate 0", [](ChoosePose::Params& p, Poses&) { p.gate = 0; });
  add_choice(list, {}, ", gate 65535", [](ChoosePose::Params& p, Poses&) { p.gate = 65535; });
  add_case(list, ChoiceCase{.wide = 65535});
  add_case(list, ChoiceCase{.map_cap = 65535, .wide = 65535});
  add_case(list, ChoiceCase{.wide = 0});
  add_case(list, ChoiceCase{.map_cap = 0}, ", nothing known");
  add_choice(list, {}, ", pose 0 off the map", [](ChoosePose::Params&, Poses& poses) { poses[0].x = 3000.0F; });
  add_choice(list, {}, ", pose 0 off the map, all vote", [](ChoosePose::Params& p, Poses& poses) {
    poses[0].x = 3000.0F;
    p.overlap_q16 = 1;
  });
}

// Values, sizes and costs at their limits.
void add_edges(std::vector<KernelCaseSource>& list) {
  for (const bool room : {true, false}) {
    add_choice(list, {.room = room, .steps = true, .points = 361}, ", gate 512",
               [](ChoosePose::Params& p, Poses&) { p.gate = 512; });
  }
  // One pose at the limit of far or just beyond: if it counted as far, a 256th of its cost would win.
  const float just_over_2 = std::nextafter(2.0F, 3.0F);
  const float just_over_angle = std::nextafter(0.05F, 1.0F);
  const PolishedPose at_limits[] = {pose_at(2.0F, 0.0F, 0.0F),
                                    pose_at(0.0F, -2.0F, 0.0F),
                                    pose_at(0.0F, 0.0F, 0.05F),
                                    pose_at(0.0F, 0.0F, -0.05F),
                                    pose_at(just_over_2, 0.0F, 0.0F),
                                    pose_at(0.0F, -just_over_2, 0.0F),
                                    pose_at(0.0F, 0.0F, just_over_angle),
                                    pose_at(0.0F, 0.0F, -just_over_angle)};
  for (std::size_t i = 0; i < std::size(at_limits); ++i) {
    const PolishedPose pose = at_limits[i];
    add_choice(list, {.poses = 2}, ", limit of far " + std::to_string(i), [pose](ChoosePose::Params& p, Poses& poses) {
      p.prior = {.weight_xy = 1.0e5F, .weight_theta = 1.0e8F};
      poses[0] = {};
      poses[1] = pose;
      p.leap_q8 = 1;
    });
  }
  // A cost of 900 with a factor that makes it 2^32 + 2: saturated, not 2.
  add_choice(list, {.points = 0, .poses = 2}, ", leap beyond 32 bits", [](ChoosePose::Params& p, Poses& poses) {
    p.prior = {.weight_xy = 1.0F};
    poses[0] = {};
    poses[1] = pose_at(30.0F, 0.0F, 0.0F);
    poses[0].x = 2.0F;
    p.leap_q8 = 1221679587U;
  });
}

// Poses 3 and 4 lie far from the prior's mean, the others do not.
void set_apart(Poses& poses) {
  poses[0] = pose_at(2.2F, -1.1F, 0.29F);
  poses[1] = pose_at(1.8F, -0.9F, 0.30F);
  poses[2] = pose_at(2.0F, -1.0F, 0.26F);
  poses[3] = pose_at(kTruePose.x + 4.0F, kTruePose.y, kTruePose.theta);
  poses[4] = pose_at(kTruePose.x, kTruePose.y, kTruePose.theta + 0.2F);
}

void add_leaps(std::vector<KernelCaseSource>& list) {
  for (const std::uint32_t leap : {0U, 1U, 26U, 255U, 256U, 333U, 0x01000000U, 0xFFFFFFFFU}) {
    add_choice(list, {}, ", leap " + std::to_string(leap), [leap](ChoosePose::Params& p, Poses& poses) {
      set_apart(poses);
      p.leap_q8 = leap;
    });
    add_choice(list, {}, ", pose 0 far, leap " + std::to_string(leap), [leap](ChoosePose::Params& p, Poses& poses) {
      set_apart(poses);
      std::swap(poses[0], poses[3]);
      p.leap_q8 = leap;
    });
  }
  // A far pose that a leap makes cheap, with a cost so high that the product needs more than 32 bits.
  add_choice(list, {.room = false, .points = 60000, .poses = 2, .map_cap = 65535, .wide = 65535}, ", a long product",
             [](ChoosePose::Params& p, Poses& poses) {
               poses = {pose_at(2.0F, -1.0F, 0.28F), pose_at(7.0F, -1.0F, 0.28F)};
               p.leap_q8 = 64;
             });
  add_choice(list, {}, ", nothing is far", [](ChoosePose::Params& p, Poses& poses) {
    set_apart(poses);
    p.leap_q8 = 26;
    p.far_sq_cells = std::numeric_limits<float>::infinity();
    p.far_rad = std::numeric_limits<float>::infinity();
  });
}

void add_ties(std::vector<KernelCaseSource>& list) {
  add_choice(list, {.poses = 17}, ", all equal", [](ChoosePose::Params&, Poses& poses) {
    for (PolishedPose& pose : poses) {
      pose = pose_at(kTruePose.x, kTruePose.y, kTruePose.theta);
      pose.evaluations = 0x20000001U;
    }
  });
  add_choice(list, {.poses = 9}, ", the best ones equal", [](ChoosePose::Params&, Poses& poses) {
    for (const std::size_t i : {3U, 5U, 8U}) {
      poses[i] = pose_at(kTruePose.x, kTruePose.y, kTruePose.theta);
      poses[i].stop = static_cast<std::uint32_t>(i);
    }
  });
  add_choice(list, {.points = 0}, ", no prior", [](ChoosePose::Params& p, Poses&) { p.prior = {}; });
  add_choice(list, {}, ", no prior", [](ChoosePose::Params& p, Poses&) { p.prior = {}; });
}

void add_extremes(std::vector<KernelCaseSource>& list) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto steep = [](ChoosePose::Params& p, Poses& poses) {
    p.prior.weight_xy = 3.0e38F;
    p.prior.weight_theta = 3.0e38F;
    p.overlap_q16 = 65536;
    poses.back() = pose_at(1.0e9F, -3.0e30F, 0.1F);
    poses[1] = poses[0] = poses.back();
  };
  add_choice(list, {}, ", steep prior", steep);
  for (const std::uint32_t points : {60000U, 65535U}) {  // the smaller number fits one invocation on lavapipe
    add_choice(list, {.points = points, .poses = 3, .map_cap = 65535, .wide = 65535}, ", saturated", steep);
  }
  add_choice(list, {.points = 65535, .poses = 2, .map_cap = 65535, .wide = 65535, .form = CostForm::kSquared},
             ", all vote", [](ChoosePose::Params& p, Poses&) { p.overlap_q16 = 65536; });
  for (const std::uint32_t leap : {0U, 512U}) {
    const std::string what = ", leap " + std::to_string(leap);
    add_choice(list, {}, ", huge poses" + what, [leap](ChoosePose::Params& p, Poses& poses) {
      p.leap_q8 = leap;
      poses[1] = pose_at(3.0e38F, 3.0e38F, 60.0F);
      poses[3] = pose_at(-kInfinity, 0.0F, 0.0F);
      poses[4] = pose_at(2.0F, 2.0e9F, -64.0F);
    });
    add_choice(list, {}, ", poses that are none" + what, [leap](ChoosePose::Params& p, Poses& poses) {
      p.leap_q8 = leap;
      poses[0] = pose_at(kNaN, 0.0F, 0.0F);
      poses[1] = pose_at(2.0F, kNaN, 0.0F);
      poses[3] = pose_at(2.0F, 0.0F, kNaN);
      poses[4] = pose_at(2.0F, 0.0F, kInfinity);
    });
    add_choice(list, {.poses = 2}, ", nothing but NaN" + what, [leap](ChoosePose::Params& p, Poses& poses) {
      p.leap_q8 = leap;
      poses[0] = poses[1] = pose_at(kNaN, kNaN, kNaN);
    });
  }
}

// Coordinates of poses, the prior's mean, its weights and its limit. The winning pose is the true one, which is not
// subnormal, because its coordinates are written.
void add_subnormals(std::vector<KernelCaseSource>& list) {
  const auto around_zero = [](ChoosePose::Params& p, Poses& poses) {
    p.prior.mean_x = kSubnormal;
    p.prior.mean_y = p.prior.mean_theta = -kSubnormal;
    p.prior.weight_xy = p.prior.weight_theta = 1.0F;
    poses[0] = pose_at(kSubnormal, -kSubnormal, kSubnormal);
    poses[1] = pose_at(kTruePose.x, kSubnormal, -kSubnormal);
    poses[2] = pose_at(kTruePose.x, kTruePose.y, kTruePose.theta);
    poses[3] = pose_at(1.0e-20F, -1.0e-20F, 1.0e-20F);
  };
  for (const Interpolation interpolation : {Interpolation::kBilinear, Interpolation::kNearest}) {
    const ChoiceCase shape{.interpolation = interpolation};
    add_choice(list, shape, ", subnormal poses", around_zero);
    add_choice(list, shape, ", subnormal poses, leap", [around_zero](ChoosePose::Params& p, Poses& poses) {
      around_zero(p, poses);
      p.leap_q8 = 200;
    });
    add_choice(list, shape, ", subnormal weights", [around_zero](ChoosePose::Params& p, Poses& poses) {
      around_zero(p, poses);
      p.prior.weight_xy = kSubnormal;
      p.prior.weight_theta = 3.0F * kSubnormal;
    });
    add_choice(list, shape, ", a subnormal limit", [around_zero](ChoosePose::Params& p, Poses& poses) {
      around_zero(p, poses);
      p.prior.weight_xy = 1.0e5F;
      p.prior.limit = kSubnormal;
    });
  }
}

KernelCase draw_choice(const std::string& name, Random& random) {
  ChoiceCase shape;
  shape.field = draw_size(random, 2);
  shape.room = random.below(2) == 0;
  shape.points = draw_count(random, 500);
  shape.poses = 1 + draw_count(random, SmallestValues::kMost);
  shape.map_cap = random.below(2) == 0 ? 5120 : draw_count(random, 65535);
  shape.wide = random.below(2) == 0 ? 2560 : draw_count(random, 65535);
  shape.interpolation = random.below(2) == 0 ? Interpolation::kBilinear : Interpolation::kNearest;
  shape.form = random.below(2) == 0 ? CostForm::kDistance : CostForm::kSquared;
  shape.change = [&random](ChoosePose::Params& params, Poses&) {
    params.gate = draw_count(random, 5120);
    params.contradiction_q16 = draw_count(random, 65536);
    params.overlap_q16 = draw_count(random, 65536);
    params.leap_q8 = draw_count(random, 1024);
    params.far_sq_cells = static_cast<float>(random.uniform(0.0, 9.0));
    params.far_rad = static_cast<float>(random.uniform(0.0, 0.1));
  };
  return shape.make(name);
}

void add_choose_pose_cases(std::vector<KernelCaseSource>& list) {
  add_sizes(list);
  add_angles(list);
  add_voters(list);
  add_edges(list);
  add_leaps(list);
  add_ties(list);
  add_extremes(list);
  add_subnormals(list);
  for (const Interpolation interpolation : {Interpolation::kBilinear, Interpolation::kNearest}) {
    add_case(list, ChoiceCase{.field = {1024, 1024, 1024}, .points = 361, .poses = 8, .interpolation = interpolation},
             CaseUse::kBenchmark);
  }
}

}  // namespace

CaseGroup ChoosePose::cases() { return {add_choose_pose_cases, {{&ChoosePose::info(), draw_choice}}}; }

}  // namespace gdtslam
