#include "cases/case_builder.hpp"
#include "cases/scan_data.hpp"
#include "gdtslam/compute/kernels/pose_cost.hpp"

namespace gdtslam {
namespace {

/// What a case of pose_cost varies.
struct CostCase {
  CaseSize field;
  std::uint32_t points;
  std::uint32_t candidates;
  std::uint32_t cap;
  double spread_cells;  ///< how far from the field's middle candidates lie
  Interpolation interpolation;
  CostForm form;
};

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
  }
  return poses;
}

void add_cost(std::vector<KernelCaseSource>& list, const CostCase& shape, bool benchmark) {
  const std::string name = size_name(shape.field) + " " + std::to_string(shape.candidates) + " poses " +
                           std::to_string(shape.points) + " points cap " + std::to_string(shape.cap) +
                           (shape.interpolation == Interpolation::kBilinear ? " bilinear" : " nearest") +
                           (shape.form == CostForm::kSquared ? " squared" : "");
  add_case<PoseCost>(
      list, name,
      [shape](const std::string& named) {
        Random random(seed_from(named));
        const PoseCost::Params params{.width = shape.field.width,
                                      .height = shape.field.height,
                                      .stride = shape.field.stride,
                                      .anchor_x = anchor_of(shape.field.width),
                                      .anchor_y = anchor_of(shape.field.height),
                                      .point_count = shape.points,
                                      .cap = shape.cap,
                                      .interpolation = shape.interpolation,
                                      .form = shape.form};
        const std::vector<std::uint16_t> field = slow_field(shape.field, shape.cap, random);
        const std::vector<PointCells> points = scattered_points(shape.field, shape.points, random);
        const std::vector<PoseCandidate> poses = make_candidates(shape, random);
        return make_case<PoseCost>(
            named, params, {shape.candidates, 1, 1},
            {grid_buffer(shape.field, field), list_buffer(points), list_buffer(poses),
             list_buffer(noise<std::uint32_t>({shape.candidates, 1, shape.candidates}, random.bits()))});
      },
      benchmark);
}

void add_arg_min(std::vector<KernelCaseSource>& list, std::uint32_t count, std::uint32_t range, bool benchmark) {
  add_case<ArgMin>(
      list, std::to_string(count) + " of " + std::to_string(range),
      [=](const std::string& name) {
        Random random(seed_from(name));
        std::vector<std::uint32_t> costs(count);
        for (std::uint32_t& cost : costs) {
          cost = 0xFFFFFFFFU - static_cast<std::uint32_t>(random.below(range));
        }
        return make_case<ArgMin>(name, {count}, {1, 1, 1},
                                 {list_buffer(costs), list_buffer(std::vector<std::uint32_t>{7, 7})});
      },
      benchmark);
}

}  // namespace

void add_pose_cost_cases(std::vector<KernelCaseSource>& list) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kCounts[] = {{0, 3},  {1, 1},   {7, 4},   {15, 8},  {16, 1},
                                                                 {17, 5}, {33, 17}, {180, 3}, {361, 70}};
  for (const Interpolation interpolation : {Interpolation::kBilinear, Interpolation::kNearest}) {
    for (const CostForm form : {CostForm::kDistance, CostForm::kSquared}) {
      for (const auto& [points, candidates] : kCounts) {
        add_cost(list, {{97, 83, 100}, points, candidates, 20 * 256, 60.0, interpolation, form}, false);
        add_cost(list, {{256, 200, 256}, points, candidates, 65535, 20.0, interpolation, form}, false);
      }
      add_cost(list, {{2, 2, 4}, 9, 6, 1000, 3.0, interpolation, form}, false);
      add_cost(list, {{5, 5, 8}, 50, 20, 255, 3.0, interpolation, form}, false);
      add_cost(list, {{64, 64, 64}, 65537, 2, 65535, 300.0, interpolation, form}, false);
    }
  }
  constexpr CaseSize kBenchField{1024, 1024, 1024};
  for (const Interpolation interpolation : {Interpolation::kBilinear, Interpolation::kNearest}) {
    add_cost(list, {kBenchField, 361, 4096, 20 * 256, 40.0, interpolation, CostForm::kDistance}, true);
  }
  add_cost(list, {kBenchField, 361, 4096, 20 * 256, 40.0, Interpolation::kBilinear, CostForm::kSquared}, true);
  add_cost(list, {kBenchField, 180, 2, 20 * 256, 4.0, Interpolation::kBilinear, CostForm::kDistance}, true);
  for (const std::uint32_t count : {1U, 2U, 15U, 16U, 17U, 255U, 1000U, 70001U}) {
    add_arg_min(list, count, 3, false);
    add_arg_min(list, count, 1U << 31U, false);
  }
  add_arg_min(list, 1, 1, false);
  add_arg_min(list, 1U << 17U, 1U << 31U, true);
}

}  // namespace gdtslam
