// What the kernels of pose_simplex.hpp refuse, each limit at its edge.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr float kFloatNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kFloatInfinity = std::numeric_limits<float>::infinity();

/// A launch that is right, and changes to it.
template <class K>
struct DescentLaunch {
  typename K::Params params;
  Extent threads;
  std::vector<std::size_t> bytes;

  void check() const { check_launch(K::info(), {bytes, std::as_bytes(std::span(&params, 1)), threads}); }
};

template <class K>
using DescentChange = std::function<void(DescentLaunch<K>&)>;

template <class K>
void expect_taken(DescentLaunch<K> launch, const DescentChange<K>& change) {
  change(launch);
  EXPECT_NO_THROW(launch.check());
}

template <class K>
void expect_refused(DescentLaunch<K> launch, const DescentChange<K>& change, const char* message) {
  change(launch);
  EXPECT_THAT([&] { launch.check(); }, ThrowsMessage<Error>(HasSubstr(message)));
}

constexpr PoseCost::Params kCost{.width = 60, .height = 40, .stride = 64, .point_count = 100, .cap = 5120};
constexpr std::size_t kFieldBytes = (64 * 39 + 60) * 2;

TEST(PoseStartsCheck, RefusesWhatDoesNotFit) {
  const DescentLaunch<PoseStarts> good{{.candidate_count = 50}, {5, 1, 1}, {50 * 16, 4 * 8, 5 * 32}};
  using L = DescentLaunch<PoseStarts>;
  expect_taken<PoseStarts>(good, [](L&) {});
  expect_taken<PoseStarts>(good, [](L& l) { l.threads = {0, 1, 1}; });
  expect_taken<PoseStarts>(good, [](L& l) { l = {{}, {1, 1, 1}, {0, 0, 32}}; });
  expect_taken<PoseStarts>(good, [](L& l) { l = {{}, {17, 1, 1}, {0, 128, 544}}; });
  expect_refused<PoseStarts>(
      good,
      [](L& l) {
        l = {{}, {18, 1, 1}, {0, 136, 576}};
      },
      "17 starts");
  expect_refused<PoseStarts>(
      good, [](L& l) { l.bytes[0] -= 1; }, "buffer 0");
  expect_refused<PoseStarts>(
      good, [](L& l) { l.bytes[1] -= 1; }, "buffer 1");
  expect_refused<PoseStarts>(
      good, [](L& l) { l.bytes[2] -= 1; }, "buffer 2");
  expect_refused<PoseStarts>(
      good, [](L& l) { l.params.candidate_count = 0xFFFFFFFFU; }, "needs 68719476720");
  expect_refused<PoseStarts>(
      good, [](L& l) { l.threads.y = 2; }, "extent");
}

/// What the cost and the prior of either kernel must be.
template <class K>
void expect_cost_and_prior_checked(const DescentLaunch<K>& good) {
  using L = DescentLaunch<K>;
  expect_taken<K>(good, [](L&) {});
  expect_refused<K>(
      good, [](L& l) { l.bytes[0] -= 1; }, "buffer 0");
  expect_refused<K>(
      good, [](L& l) { l.bytes[1] -= 1; }, "buffer 1");
  expect_refused<K>(
      good, [](L& l) { l.bytes[2] -= 1; }, "buffer 2");
  expect_refused<K>(
      good, [](L& l) { l.bytes.pop_back(); }, "buffers given");
  expect_refused<K>(
      good, [](L& l) { l.threads.y = 2; }, "extent");
  expect_refused<K>(
      good, [](L& l) { l.params.cost.stride = 62; }, "stride");
  expect_refused<K>(
      good, [](L& l) { l.params.cost.width = 1; }, "2 x 2");
  expect_refused<K>(
      good, [](L& l) { l.params.cost.anchor_y = -(1 << 21) - 1; }, "anchor");
  expect_refused<K>(
      good, [](L& l) { l.params.cost.cap = 65536; }, "cap");
  expect_refused<K>(
      good, [](L& l) { l.params.cost.form = static_cast<CostForm>(2); }, "form");
  expect_taken<K>(good, [](L& l) { l.params.prior.limit = 0.0F; });
  for (const float bad : {-1.0F, kFloatNaN, kFloatInfinity}) {
    expect_refused<K>(
        good, [=](L& l) { l.params.prior.weight_xy = bad; }, "weight");
    expect_refused<K>(
        good, [=](L& l) { l.params.prior.weight_theta = bad; }, "weight");
    expect_refused<K>(
        good, [=](L& l) { l.params.prior.limit = bad; }, "limit");
  }
  expect_refused<K>(
      good, [](L& l) { l.params.prior.limit = 1.0001e9F; }, "limit");
  expect_refused<K>(
      good, [](L& l) { l.params.prior.mean_theta = kFloatNaN; }, "mean");
}

TEST(PoseSimplexCheck, RefusesWhatDoesNotFit) {
  const DescentLaunch<PoseSimplex> good{{.cost = kCost, .prior = {}}, {3, 1, 1}, {kFieldBytes, 800, 96}};
  using L = DescentLaunch<PoseSimplex>;
  expect_cost_and_prior_checked(good);
  expect_taken<PoseSimplex>(good, [](L& l) { l.threads.x = 0; });
  expect_taken<PoseSimplex>(good, [](L& l) { l.params.step_cells = -2.0F; });
  for (const float bad : {kFloatNaN, kFloatInfinity, -kFloatInfinity}) {
    expect_refused<PoseSimplex>(
        good, [=](L& l) { l.params.step_cells = bad; }, "step");
    expect_refused<PoseSimplex>(
        good, [=](L& l) { l.params.step_rad = bad; }, "step");
  }
  for (const float bad : {kFloatNaN, kFloatInfinity, -0.001F}) {
    expect_refused<PoseSimplex>(
        good, [=](L& l) { l.params.stop_cells = bad; }, "stop");
    expect_refused<PoseSimplex>(
        good, [=](L& l) { l.params.stop_rad = bad; }, "stop");
  }
  expect_taken<PoseSimplex>(good, [](L& l) { l.params.max_evaluations = PoseSimplex::kMostEvaluations; });
  expect_refused<PoseSimplex>(
      good, [](L& l) { l.params.max_evaluations = PoseSimplex::kMostEvaluations + 1; }, "evaluations");
  const auto with_points = [](std::uint32_t count) {
    return [=](L& l) {
      l.params.cost.point_count = count;
      l.bytes[1] = 8 * std::size_t{count};
    };
  };
  expect_taken<PoseSimplex>(good, with_points(65537));
  expect_refused<PoseSimplex>(good, with_points(65538), "points");
}

TEST(ChoosePoseCheck, RefusesWhatDoesNotFit) {
  const DescentLaunch<ChoosePose> good{
      {.cost = kCost, .prior = {}, .pose_count = 3}, {1, 1, 1}, {kFieldBytes, 800, 96, 52}};
  using L = DescentLaunch<ChoosePose>;
  expect_cost_and_prior_checked(good);
  expect_refused<ChoosePose>(
      good, [](L& l) { l.bytes[3] -= 1; }, "buffer 3");
  expect_refused<ChoosePose>(
      good, [](L& l) { l.threads.x = 2; }, "extent");
  expect_refused<ChoosePose>(
      good, [](L& l) { l.params.pose_count = 0; }, "poses");
  expect_refused<ChoosePose>(
      good, [](L& l) { l.params.pose_count = 4; }, "buffer 2");
  const auto with_poses = [](std::uint32_t count) {
    return [=](L& l) {
      l.params.pose_count = count;
      l.bytes[2] = 32 * std::size_t{count};
    };
  };
  expect_taken<ChoosePose>(good, with_poses(17));
  expect_refused<ChoosePose>(good, with_poses(18), "poses");
  const auto with_points = [](std::uint32_t count) {
    return [=](L& l) {
      l.params.cost.point_count = count;
      l.bytes[1] = 8 * std::size_t{count};
    };
  };
  expect_taken<ChoosePose>(good, with_points(65535));
  expect_refused<ChoosePose>(good, with_points(65536), "points");
  expect_taken<ChoosePose>(good, [](L& l) { l.params.map_cap = l.params.gate = 65535; });
  expect_refused<ChoosePose>(
      good, [](L& l) { l.params.map_cap = 65536; }, "16 bits");
  expect_refused<ChoosePose>(
      good, [](L& l) { l.params.gate = 65536; }, "16 bits");
  expect_taken<ChoosePose>(good, [](L& l) { l.params.contradiction_q16 = l.params.overlap_q16 = 65536; });
  expect_refused<ChoosePose>(
      good, [](L& l) { l.params.contradiction_q16 = 65537; }, "share");
  expect_refused<ChoosePose>(
      good, [](L& l) { l.params.overlap_q16 = 65537; }, "share");
  expect_taken<ChoosePose>(good, [](L& l) { l.params.far_sq_cells = l.params.far_rad = kFloatInfinity; });
  expect_refused<ChoosePose>(
      good, [](L& l) { l.params.far_sq_cells = kFloatNaN; }, "far");
  expect_refused<ChoosePose>(
      good, [](L& l) { l.params.far_rad = -0.1F; }, "far");
}

}  // namespace
}  // namespace gdtslam::test
