// The matcher `exhaustive` from its window to its verdict in one submission: what each kernel leaves to the next is the
// CPU's, byte for byte, and where the truth is known the verdict is the truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"
#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/random.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

constexpr std::uint32_t kWidth = 150;
constexpr std::uint32_t kHeight = 130;
constexpr std::uint32_t kStride = 152;
constexpr std::uint32_t kMapCap = 20 * 256;
constexpr std::int32_t kAnchor = 60;
constexpr std::size_t kDescents = 4;
constexpr std::uint64_t kScenes = 36;

/// A scan to be matched.
struct Scene {
  std::vector<std::uint16_t> field;
  std::vector<PointCells> points;
  PoseCost::Params cost;
  PoseLattice::Params window;
  std::array<std::uint32_t, kDescents> gates{};
  std::uint32_t wanted = 1;
  ChoosePose::Params choice;
  PoseCandidate truth;    ///< where the points lie on the walls
  bool is_known = false;  ///< whether there are walls, and enough points to find the truth
};

struct Wall {
  double x;
  double y;
};

/// A room with two partitions, as cells of its walls, a different one for each generator.
std::vector<Wall> make_walls(Random& random) {
  const double left = random.uniform(15.0, 30.0);
  const double right = random.uniform(110.0, 130.0);
  const double low = random.uniform(15.0, 30.0);
  const double high = random.uniform(95.0, 110.0);
  const double middle = random.uniform(50.0, 90.0);
  std::vector<Wall> walls;
  for (double x = left; x <= right; x += 1.0) {
    walls.push_back({x, low});
    walls.push_back({x, high});
  }
  for (double y = low; y <= high; y += 1.0) {
    walls.push_back({left, y});
    walls.push_back({right, y});
  }
  for (double step = 0.0; step < 25.0; step += 1.0) {
    walls.push_back({middle, low + step});
    walls.push_back({left + 1.3 * step, middle - 0.4 * step});
  }
  return walls;
}

/// Distances to the walls in 1/256 cell, the border at the cap.
std::vector<std::uint16_t> field_of(const std::vector<Wall>& walls) {
  std::vector<std::uint16_t> field(std::size_t{kStride} * kHeight, 0xABCD);
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      double sq_least = 400.0;
      for (const Wall& wall : walls) {
        const double dx = x + 0.5 - wall.x;
        const double dy = y + 0.5 - wall.y;
        sq_least = std::min(sq_least, dx * dx + dy * dy);
      }
      const bool border = x < 2 || y < 2 || x + 2 >= kWidth || y + 2 >= kHeight;
      field[std::size_t{y} * kStride + x] =
          static_cast<std::uint16_t>(border ? kMapCap : std::lround(256.0 * std::sqrt(sq_least)));
    }
  }
  return field;
}

std::vector<std::uint16_t> noise_field(Random& random) {
  std::vector<std::uint16_t> field(std::size_t{kStride} * kHeight);
  for (std::uint16_t& value : field) {
    value = static_cast<std::uint16_t>(random.below(kMapCap + 1));
  }
  return field;
}

float drawn(Random& random, double low, double high) { return static_cast<float>(random.uniform(low, high)); }

/// Points on the walls as they are seen from the true pose, a twentieth of a cell off.
std::vector<PointCells> points_of(const std::vector<Wall>& walls, const PoseCandidate& truth, std::uint32_t count,
                                  Random& random) {
  const auto [s, c] = sin_cos(static_cast<double>(truth.theta));
  std::vector<PointCells> points(count);
  for (PointCells& point : points) {
    const Wall& wall = walls[random.below(walls.size())];
    const double dx = wall.x - kAnchor - static_cast<double>(truth.x) + random.uniform(-0.05, 0.05);
    const double dy = wall.y - kAnchor - static_cast<double>(truth.y) + random.uniform(-0.05, 0.05);
    point = {static_cast<float>(c * dx + s * dy), static_cast<float>(c * dy - s * dx)};
  }
  return points;
}

PriorParams make_prior(const PoseCandidate& mean, std::uint32_t points, Random& random) {
  const float weight = static_cast<float>(points) * drawn(random, 0.0, 4.0);
  return {.mean_x = mean.x,
          .mean_y = mean.y,
          .mean_theta = mean.theta,
          .weight_xy = weight,
          .weight_theta = 300.0F * weight,
          .limit = drawn(random, 1.0e3, 1.0e9)};
}

ChoosePose::Params make_choice(const Scene& scene, Random& random) {
  ChoosePose::Params choice{.cost = scene.cost, .prior = scene.window.prior, .pose_count = scene.wanted + 1};
  choice.cost.cap = 2560;
  choice.map_cap = kMapCap;
  choice.gate = static_cast<std::uint32_t>(random.below(1000));
  choice.contradiction_q16 = static_cast<std::uint32_t>(random.below(65537));
  choice.overlap_q16 = static_cast<std::uint32_t>(random.below(65537));
  choice.leap_q8 = static_cast<std::uint32_t>(random.below(3) * 192);
  choice.far_sq_cells = drawn(random, 0.0, 20.0);
  choice.far_rad = drawn(random, 0.0, 0.2);
  return choice;
}

Scene make_scene(std::uint64_t seed) {
  constexpr std::uint32_t kPointCounts[] = {361, 1, 180, 2500, 1081, 37};
  Random random(seed);
  Scene scene;
  const std::uint32_t points = kPointCounts[seed % std::size(kPointCounts)];
  const std::vector<Wall> walls = make_walls(random);
  scene.truth = {drawn(random, -8.0, 8.0), drawn(random, -8.0, 8.0), drawn(random, -3.1, 3.1), 0};
  scene.is_known = seed % 4 != 3 && points >= 100;
  scene.field = seed % 4 == 3 ? noise_field(random) : field_of(walls);
  scene.points = points_of(walls, scene.truth, points, random);
  scene.cost = {.width = kWidth,
                .height = kHeight,
                .stride = kStride,
                .anchor_x = kAnchor,
                .anchor_y = kAnchor,
                .point_count = points,
                .cap = kMapCap,
                .interpolation = random.below(3) == 0 ? Interpolation::kNearest : Interpolation::kBilinear,
                .form = random.below(3) == 0 ? CostForm::kSquared : CostForm::kDistance};
  const PoseCandidate predicted{scene.truth.x + drawn(random, -3.0, 3.0), scene.truth.y + drawn(random, -3.0, 3.0),
                                scene.truth.theta + drawn(random, -0.15, 0.15), 0};
  scene.window = {.centre_x = predicted.x,
                  .centre_y = predicted.y,
                  .centre_theta = predicted.theta,
                  .step_cells = 1.25F,
                  .step_rad = 0.03F,
                  .count_xy = 2 * static_cast<std::uint32_t>(random.below(3)) + 5,
                  .count_theta = 2 * static_cast<std::uint32_t>(random.below(6)) + 11,
                  .prior = make_prior(predicted, points, random)};
  scene.gates = {kMapCap, 2560, 1280, 400};
  scene.wanted = 1 + static_cast<std::uint32_t>(random.below(SmallestValues::kMost));
  scene.choice = make_choice(scene, random);
  return scene;
}

/// What a run left in every buffer on its way, and the last of it.
struct Outcome {
  std::vector<std::pair<std::string, std::vector<std::byte>>> stages;
  MatchVerdict verdict;
};

/// The buffers of a scene, and the downloads that wait behind the kernels.
class Chain {
 public:
  Chain(Backend& backend, const Scene& scene)
      : backend_(backend),
        scene_(scene),
        samples_(scene.window.count_xy * scene.window.count_xy * scene.window.count_theta),
        field_(uploaded(std::as_bytes(std::span(scene.field)))),
        points_(uploaded(std::as_bytes(std::span(scene.points)))),
        candidates_(backend.allocate(samples_ * sizeof(PoseCandidate))),
        costs_(backend.allocate(samples_ * sizeof(std::uint32_t))),
        minima_(backend.allocate(samples_ * sizeof(std::uint32_t))),
        picks_(backend.allocate(scene.wanted * 2 * sizeof(std::uint32_t))),
        poses_(backend.allocate((scene.wanted + 1) * sizeof(PolishedPose))),
        verdict_(backend.allocate(sizeof(MatchVerdict))) {}

  void launch() {
    launch_window();
    launch_descents();
    run<ChoosePose>(backend_, scene_.choice, {1, 1, 1}, field_, points_, poses_, verdict_);
    keep("verdict", verdict_);
  }

  Outcome outcome() {
    Outcome result;
    for (const auto& [name, download] : downloads_) {
      std::vector<std::byte> bytes(download.bytes);
      backend_.finish_download(download, bytes);
      result.stages.emplace_back(name, std::move(bytes));
    }
    std::memcpy(&result.verdict, result.stages.back().second.data(), sizeof(MatchVerdict));
    return result;
  }

 private:
  void launch_window() {
    const auto& [n, angles] = std::pair(scene_.window.count_xy, scene_.window.count_theta);
    run<PoseLattice>(backend_, scene_.window, {samples_, 1, 1}, candidates_);
    keep("candidates", candidates_);
    run<PoseCost>(backend_, scene_.cost, {samples_, 1, 1}, field_, points_, candidates_, costs_);
    keep("costs", costs_);
    run<LatticeMinima>(backend_, {.count_xy = n, .count_theta = angles}, {samples_, 1, 1}, costs_, minima_);
    keep("minima", minima_);
    run<SmallestValues>(backend_, {.count = samples_, .wanted = scene_.wanted}, {1, 1, 1}, minima_, picks_);
    keep("picks", picks_);
  }

  void launch_descents() {
    const std::uint32_t poses = scene_.wanted + 1;
    run<PoseStarts>(backend_,
                    {.x = scene_.window.centre_x,
                     .y = scene_.window.centre_y,
                     .theta = scene_.window.centre_theta,
                     .candidate_count = samples_},
                    {poses, 1, 1}, candidates_, picks_, poses_);
    keep("starts", poses_);
    for (const std::uint32_t gate : scene_.gates) {
      PoseSimplex::Params params{.cost = scene_.cost, .prior = scene_.window.prior, .step_cells = 1.0F};
      params.cost.cap = gate;
      run<PoseSimplex>(backend_, params, {poses, 1, 1}, field_, points_, poses_);
      keep("descent to gate " + std::to_string(gate), poses_);
    }
  }

  Buffer uploaded(std::span<const std::byte> bytes) {
    Buffer buffer = backend_.allocate(bytes.size());
    backend_.upload(buffer, bytes);
    return buffer;
  }
  void keep(std::string name, const Buffer& buffer) {
    downloads_.emplace_back(std::move(name), backend_.start_download(buffer, buffer.bytes()));
  }

  Backend& backend_;
  const Scene& scene_;
  std::uint32_t samples_;
  Buffer field_;
  Buffer points_;
  Buffer candidates_;
  Buffer costs_;
  Buffer minima_;
  Buffer picks_;
  Buffer poses_;
  Buffer verdict_;
  std::vector<std::pair<std::string, PendingDownload>> downloads_;
};

Outcome run_chain(Backend& backend, const Scene& scene) {
  Chain chain(backend, scene);
  chain.launch();
  return chain.outcome();
}

class ExhaustiveChain : public testing::TestWithParam<ShaderVariants> {
 protected:
  void SetUp() override { GDTSLAM_NEEDS_VULKAN(); }
  std::unique_ptr<VulkanBackend> device() {
    VulkanOptions options;
    options.variants = GetParam();
    return test_backend(options);
  }
  std::unique_ptr<Backend> cpu = make_cpu_backend({});
};

TEST_P(ExhaustiveChain, IsTheCpusAtEveryStageInOneSubmission) {
  const auto backend = device();
  std::array<std::size_t, 2> chosen{};  // the prediction, another
  for (std::uint64_t seed = 0; seed < kScenes; ++seed) {
    const Scene scene = make_scene(seed);
    const Outcome expected = run_chain(*cpu, scene);
    const std::uint64_t submissions = backend->submit_count();
    const Outcome found = run_chain(*backend, scene);
    EXPECT_EQ(backend->submit_count() - submissions, 1U) << "scene " << seed;
    ASSERT_EQ(found.stages.size(), expected.stages.size());
    for (std::size_t i = 0; i < found.stages.size(); ++i) {
      ASSERT_TRUE(found.stages[i].second == expected.stages[i].second)
          << "scene " << seed << ": " << found.stages[i].first << " differ from the CPU's";
    }
    ++chosen[found.verdict.chosen == 0 ? 0 : 1];
  }
  EXPECT_GT(chosen[0], 0U);
  EXPECT_GT(chosen[1], 0U);
}

// Bytes could be equal and all wrong: the pose that the points were made with is the pose that is found, to the half
// cell that a field of distances to cells knows its walls to.
TEST_P(ExhaustiveChain, FindsThePoseThatThePointsWereSeenFrom) {
  const auto backend = device();
  std::size_t known = 0;
  for (std::uint64_t seed = 0; seed < kScenes; ++seed) {
    Scene scene = make_scene(seed);
    if (!scene.is_known) {
      continue;
    }
    ++known;
    scene.window.prior.weight_xy = 0.0F;
    scene.window.prior.weight_theta = 0.0F;
    scene.choice.prior = scene.window.prior;
    scene.choice.leap_q8 = 0;
    const MatchVerdict verdict = run_chain(*backend, scene).verdict;
    EXPECT_NEAR(verdict.x, scene.truth.x, 0.5) << "scene " << seed;
    EXPECT_NEAR(verdict.y, scene.truth.y, 0.5) << "scene " << seed;
    EXPECT_NEAR(verdict.theta, scene.truth.theta, 0.01) << "scene " << seed;
  }
  EXPECT_GT(known, 15U);
}

// A deliberate fault: were the shader's arithmetic off by one constant, the comparison above would see it.
TEST_P(ExhaustiveChain, SeesAConstantThatIsWrong) {
  constexpr auto kRight = std::bit_cast<std::uint32_t>(256.0F);
  constexpr auto kWrong = std::bit_cast<std::uint32_t>(255.0F);
  std::size_t edits = 0;
  VulkanOptions options;
  options.variants = GetParam();
  options.edit_shader = [&](std::string_view shader, std::vector<std::uint32_t>& spirv) {
    if (shader.starts_with("pose_simplex")) {
      edits += static_cast<std::size_t>(std::count(spirv.begin(), spirv.end(), kRight));
      std::replace(spirv.begin(), spirv.end(), kRight, kWrong);
    }
  };
  const auto faulty = test_backend(options);
  const Scene scene = make_scene(0);
  const Outcome expected = run_chain(*cpu, scene);
  const Outcome found = run_chain(*faulty, scene);
  EXPECT_GT(edits, 0U);
  for (std::size_t i = 0; i < found.stages.size(); ++i) {
    const bool is_behind = found.stages[i].first.starts_with("descent") || found.stages[i].first == "verdict";
    EXPECT_EQ(found.stages[i].second != expected.stages[i].second, is_behind) << found.stages[i].first;
  }
}

std::string variant_name(const testing::TestParamInfo<ShaderVariants>& variants) {
  constexpr std::array kNames{"ByDevice", "Wide", "Narrow"};
  return kNames[static_cast<std::size_t>(variants.param)];
}

INSTANTIATE_TEST_SUITE_P(Variants, ExhaustiveChain,
                         testing::Values(ShaderVariants::kByDevice, ShaderVariants::kWide, ShaderVariants::kNarrow),
                         variant_name);

}  // namespace
}  // namespace gdtslam::test
