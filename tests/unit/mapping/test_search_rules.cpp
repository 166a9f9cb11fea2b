// What a search may be asked, how far it reaches, and what poses cost by their prior: by hand, at and beside each
// limit.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/mapping/certified/crop.hpp"
#include "engine/mapping/cost/objective.hpp"
#include "engine/mapping/map/local_field.hpp"
#include "engine/mapping/match/descents.hpp"
#include "engine/mapping/match/exhaustive.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/pose_matchers.hpp"

namespace gdtslam {
namespace {

using test::PoseNear;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kEdge_m = 0.05;  // of a cell

/// All cells at the cap.
class BareField {
 public:
  explicit BareField(std::uint32_t width = 8, std::uint32_t height = 8, std::uint16_t cap = 2000)
      : cells_(std::size_t{width} * height, cap),
        view_{.cells = cells_.data(), .width = width, .height = height, .stride = width, .first_cell = {}, .cap = cap} {
  }
  FieldView& view() { return view_; }
  std::uint16_t& cell(std::size_t index) { return cells_[index]; }
  [[nodiscard]] bool is_taken() const {
    try {
      const CertifiedMap map(view_, Isa::kBaseline);
      return true;
    } catch (const InputError&) {
      return false;
    }
  }

 private:
  std::vector<std::uint16_t> cells_;
  FieldView view_;
};

// The stated bound holds what is kept and three copies of the field in bytes, which are gone then: within the 64 cells
// to which each side is rounded, and for a thin field, whose margins are most of it, too.
TEST(CertifiedField, SaysBeforeHowManyBytesItWillHold) {
  using Windows = CertifiedMap::Windows;
  for (const auto& [width, height] : {std::pair(8U, 8U), std::pair(8U, 4000U), std::pair(300U, 500U)}) {
    BareField field(width, height);
    for (const Windows windows : {Windows::kAnyWindows, Windows::kSmallWindows, Windows::kNearWindows}) {
      const std::uint64_t kept = CertifiedMap(field.view(), Isa::kBaseline, windows).bytes();
      const std::uint64_t stated = CertifiedMap::most_bytes(width, height, windows);
      EXPECT_GE(stated, kept + 3 * std::uint64_t{width} * height) << width << " x " << height;
      EXPECT_LE(stated, CertifiedMap::most_bytes(width + 64, height + 64, windows));
      const std::uint64_t room = 256;  // for the widest squares, rounded, on both sides
      EXPECT_LE(stated, 2 * kept + 3 * (width + room) * (height + room)) << width << " x " << height;
    }
  }
}

TEST(CertifiedField, IsFourCellsWideAndHighAtLeast) {
  EXPECT_TRUE(BareField(4, 4).is_taken());
  EXPECT_FALSE(BareField(3, 4).is_taken());
  EXPECT_FALSE(BareField(4, 3).is_taken());
  BareField field;
  field.view().stride = 7;
  EXPECT_FALSE(field.is_taken()) << "rows that overlap";
  EXPECT_FALSE(BareField(8, 8, 0).is_taken()) << "a cap of 0";
  EXPECT_TRUE(BareField(8, 8, 1).is_taken());
  for (const double resolution_m : {0.0, -0.05, kNotANumber, std::numeric_limits<double>::infinity()}) {
    BareField other;
    other.view().resolution_m = resolution_m;
    EXPECT_FALSE(other.is_taken()) << resolution_m;
  }
}

// Of 7 by 6 cells those in the middle, 3 by 2, may be anything.
TEST(CertifiedField, HasTheCapInTwoRowsAndColumnsAtEachSide) {
  for (std::size_t y = 0; y < 6; ++y) {
    for (std::size_t x = 0; x < 7; ++x) {
      BareField field(7, 6);
      field.cell(y * 7 + x) = 0;
      EXPECT_EQ(field.is_taken(), x >= 2 && x < 5 && y >= 2 && y < 4) << x << " " << y;
    }
  }
}

class CertifiedQuestion : public testing::Test {
 protected:
  bool is_answered() {
    try {
      static_cast<void>(find_pose(map_, points_, window_, options_));
      return true;
    } catch (const InputError&) {
      return false;
    }
  }
  void SetUp() override {
    points_ = {{1.0F, 0.0F}};
    window_ = {.centre = {}, .half_x_m = 0.0, .half_y_m = 0.0, .half_theta_rad = 0.0};
    options_ = {};
  }

  BareField field_;
  CertifiedMap map_{field_.view(), Isa::kBaseline};
  std::vector<PointCells> points_;
  PoseWindow window_;
  CertifiedOptions options_;
};

TEST_F(CertifiedQuestion, HasPointsThatAreFinite) {
  EXPECT_TRUE(is_answered());
  points_.resize(kMostCertifiedPoints, {1.0F, 0.0F});
  EXPECT_TRUE(is_answered());
  points_.push_back({1.0F, 0.0F});
  EXPECT_FALSE(is_answered());
  points_.clear();
  EXPECT_FALSE(is_answered());
  points_ = {{0.0F, std::numeric_limits<float>::quiet_NaN()}};
  EXPECT_FALSE(is_answered());
  points_ = {{std::numeric_limits<float>::infinity(), 0.0F}};
  EXPECT_FALSE(is_answered());
}

TEST_F(CertifiedQuestion, HasAWindowAndAGapThatAreLengths) {
  for (double PoseWindow::*half : {&PoseWindow::half_x_m, &PoseWindow::half_y_m, &PoseWindow::half_theta_rad}) {
    SetUp();
    EXPECT_TRUE(is_answered());
    for (const double wrong : {-0.1, kNotANumber}) {
      window_.*half = wrong;
      EXPECT_FALSE(is_answered()) << wrong;
    }
  }
  SetUp();
  window_.centre.theta_rad = kNotANumber;
  EXPECT_FALSE(is_answered());
  SetUp();
  options_.gap_m = 0.0;
  EXPECT_TRUE(is_answered());
  options_.gap_m = -0.001;
  EXPECT_FALSE(is_answered());
  SetUp();
  options_.starts = {Pose2{}, Pose2{kNotANumber, 0.0, 0.0}};
  EXPECT_FALSE(is_answered());
}

TEST_F(CertifiedQuestion, HasAPriorThatIsFinite) {
  const auto with_prior = [&](const WindowPrior& prior) {
    options_.prior = prior;
    return is_answered();
  };
  EXPECT_TRUE(with_prior({.mean = {}, .weight_xy = 0.0F, .weight_theta = 0.0F, .limit = 0.0F}));
  EXPECT_TRUE(with_prior({.mean = {}, .weight_xy = 1.0F, .weight_theta = 1.0F, .limit = 1.0e9F}));
  EXPECT_FALSE(with_prior({.mean = {}, .limit = 1.0e9F + 64.0F}));
  EXPECT_FALSE(with_prior({.mean = {}, .limit = -1.0F}));
  EXPECT_FALSE(with_prior({.mean = {}, .weight_xy = -1.0F}));
  EXPECT_FALSE(with_prior({.mean = {}, .weight_theta = -1.0F}));
  EXPECT_FALSE(with_prior({.mean = {kNotANumber, 0.0, 0.0}}));
  EXPECT_FALSE(with_prior({.mean = {}, .weight_xy = std::numeric_limits<float>::infinity()}));
  EXPECT_FALSE(with_prior({.mean = {}, .weight_theta = std::numeric_limits<float>::infinity()}));
}

TEST(PoseWindow, HoldsItsEdges) {
  const PoseWindow window{.centre = {1.0, 2.0, 3.0}, .half_x_m = 0.5, .half_y_m = 0.25, .half_theta_rad = 0.5};
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(window.holds({1.0 + side * 0.5, 2.0, 3.0}));
    EXPECT_FALSE(window.holds({1.0 + side * 0.501, 2.0, 3.0}));
    EXPECT_TRUE(window.holds({1.0, 2.0 + side * 0.25, 3.0}));
    EXPECT_FALSE(window.holds({1.0, 2.0 + side * 0.251, 3.0}));
    EXPECT_TRUE(window.holds({1.0, 2.0, 3.0 + side * 0.5 - 2.0 * kPi})) << "the short way";
    EXPECT_FALSE(window.holds({1.0, 2.0, 3.0 + side * 0.501}));
  }
  EXPECT_TRUE((PoseWindow{.centre = {}, .half_theta_rad = kPi}).holds({0.0, 0.0, kPi}));
}

TEST(ExcludedPoses, AreThoseNearerInBothThanTheirLimits) {
  const ExcludedPoses excluded{.around = {1.0, 2.0, 3.0}, .within_m = 5.0, .within_rad = 0.5};
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(excluded.hold({1.0 + side * 2.999, 2.0 + 4.0, 3.0}));
    EXPECT_FALSE(excluded.hold({1.0 + side * 3.0, 2.0 + 4.0, 3.0})) << "five metres sharp";
    EXPECT_FALSE(excluded.hold({1.0 + 3.0, 2.0 + side * 4.0, 3.0}));
    EXPECT_TRUE(excluded.hold({1.0, 2.0, 3.0 + side * 0.499 - 2.0 * kPi}));
    EXPECT_FALSE(excluded.hold({1.0, 2.0, 3.0 + side * 0.501}));
  }
}

TEST(CertifiedStop, EachHasItsName) {
  std::set<std::string_view> names;
  for (int k = 0; k <= static_cast<int>(CertifiedStop::kNothingAllowed); ++k) {
    names.insert(to_string(static_cast<CertifiedStop>(k)));
  }
  EXPECT_EQ(names.size(), 6U);
  EXPECT_EQ(to_string(CertifiedStop::kGapReached), "gap-reached");
  EXPECT_EQ(to_string(CertifiedStop::kNothingAllowed), "nothing-allowed");
}

// A return ten cells ahead. Beside each cell there is one more to read between centres.
TEST(ReachedCells, AreThoseOfEachPoseOfTheWindow) {
  const std::vector<PointCells> ahead{{10.0F, 0.0F}};
  const auto box_of = [&](const PoseWindow& window) { return reached_from(window, ahead, kEdge_m).box; };
  EXPECT_EQ(box_of({.centre = {}, .half_x_m = 0.0, .half_y_m = 0.0, .half_theta_rad = 0.0}),
            (CellBox{{9, -1}, {12, 2}}));
  EXPECT_EQ(box_of({.centre = {0.52, -0.23, 0.0}, .half_x_m = 0.1, .half_y_m = 0.2, .half_theta_rad = 0.0}),
            (CellBox{{17, -10}, {24, 1}}));
  EXPECT_EQ(box_of({.centre = {0.02, 0.02, 0.5 * kPi}, .half_x_m = 0.0, .half_y_m = 0.0, .half_theta_rad = 0.0}),
            (CellBox{{-1, 9}, {2, 12}}));
  // Turned by 0.2 either way a point at 10 moves by 20 sin 0.1 = 1.997 at most.
  EXPECT_EQ(box_of({.centre = {}, .half_x_m = 0.0, .half_y_m = 0.0, .half_theta_rad = 0.2}),
            (CellBox{{7, -3}, {13, 3}}));
  for (const double half_rad : {kPi, 10.0}) {  // all around
    EXPECT_EQ(box_of({.centre = {0.01, 0.01, 0.0}, .half_x_m = 0.0, .half_y_m = 0.0, .half_theta_rad = half_rad}),
              (CellBox{{-11, -21}, {32, 22}}));
  }
}

TEST(ReachedCells, OfASmallWindowLessIsPrepared) {
  const auto windows = [](double x_m, double y_m, double rad) {
    return reached_from({.centre = {}, .half_x_m = x_m, .half_y_m = y_m, .half_theta_rad = rad}, {}, kEdge_m).windows;
  };
  EXPECT_EQ(windows(0.8, 0.8, 0.5), CertifiedMap::kNearWindows);
  EXPECT_EQ(windows(0.81, 0.1, 0.1), CertifiedMap::kSmallWindows);
  EXPECT_EQ(windows(0.1, 0.81, 0.1), CertifiedMap::kSmallWindows);
  EXPECT_EQ(windows(0.1, 0.1, 0.51), CertifiedMap::kSmallWindows);
}

class SmallMap : public testing::Test {
 protected:
  void add(const std::vector<Point2>& points) {
    const KeyframeCells keyframe = keyframe_of(points, kEdge_m, 10);
    map_.grow_to_hold(keyframe.window);
    local_.prepare(keyframe, map_);
    local_.merge_into(map_, {.rule = MergeRule::kWorking, .threshold = 256, .lift = 0});
  }

  std::unique_ptr<Backend> backend_ = make_cpu_backend({});
  GlobalField map_{*backend_, kEdge_m, 10, 1U << 24U};
  LocalField local_{*backend_, 10};
};

TEST_F(SmallMap, ACropHasTheCellsUpToItsCapAndIsKeptWhileNothingChanges) {
  add({{0.51, 0.51}});
  CertifiedCrop crop(4 * 256);
  const ReachedCells reached{{{5, 5}, {16, 16}}, CertifiedMap::kSmallWindows};
  const CertifiedMap* const first = &crop.of(map_, reached, Isa::kBaseline);
  const FieldView& view = first->field();
  EXPECT_EQ(view.cap, 4 * 256);
  EXPECT_EQ(view.resolution_m, kEdge_m);
  const CellBox box{view.first_cell, view.first_cell + CellOffset{static_cast<std::int32_t>(view.width),
                                                                  static_cast<std::int32_t>(view.height)}};
  EXPECT_LE(box.min.x, 5 - 4);
  EXPECT_LE(box.min.y, 5 - 4);
  EXPECT_GE(box.end.x, 16 + 4);
  EXPECT_GE(box.end.y, 16 + 4);
  for (std::int32_t y = 0; y < box.height(); ++y) {
    for (std::int32_t x = 0; x < box.width(); ++x) {
      const bool is_edge = std::min({x, y, box.width() - 1 - x, box.height() - 1 - y}) < 2;
      const std::uint16_t known = std::min<std::uint16_t>(map_.at({box.min.x + x, box.min.y + y}), 4 * 256);
      const std::size_t place = static_cast<std::size_t>(y) * view.stride + static_cast<std::size_t>(x);
      ASSERT_EQ(view.cells[place], is_edge ? 4 * 256 : known) << x << " " << y;
    }
  }
  EXPECT_EQ(
      view.cells[static_cast<std::size_t>(10 - box.min.y) * view.stride + static_cast<std::size_t>(10 - box.min.x)], 0)
      << "the obstacle";
  const std::size_t bytes = first->bytes();
  EXPECT_EQ(crop.of(map_, reached, Isa::kBaseline).bytes(), bytes);
  EXPECT_LT(crop.of(map_, {reached.box, CertifiedMap::kNearWindows}, Isa::kBaseline).bytes(), bytes);
  add({{0.61, 0.61}});
  const FieldView& later = crop.of(map_, reached, Isa::kBaseline).field();
  EXPECT_EQ(later.cells[static_cast<std::size_t>(12 - later.first_cell.y) * later.stride +
                        static_cast<std::size_t>(12 - later.first_cell.x)],
            0)
      << "what came later";
  CertifiedCrop wide(100 * 256);
  EXPECT_EQ(wide.of(map_, reached, Isa::kBaseline).field().cap, map_.cap()) << "no more than the map's";
}

// Without points there is the prior alone: weight times the square of what is off, no more than the limit for either.
TEST_F(SmallMap, APriorCostsTheSquareOfWhatIsOffUpToItsLimit) {
  add({{0.51, 0.51}});
  Objective objective(map_, Interpolation::kBilinear, CostForm::kDistance);
  objective.set_cap(map_.cap());
  const CellPose off{3.0F, -1.0F, 0.75F};
  const auto cost_with = [&](float limit) {
    objective.set_prior({.mean_x = 1.0F,
                         .mean_y = -2.0F,
                         .mean_theta = 0.25F,
                         .weight_xy = 10.0F,
                         .weight_theta = 8.0F,
                         .limit = limit});
    return objective.evaluate(off);
  };
  EXPECT_EQ(cost_with(1000.0F), 52U) << "10 (4 + 1) and 8 / 4";
  EXPECT_EQ(cost_with(20.0F), 22U);
  EXPECT_EQ(cost_with(1.0F), 2U);
  cost_with(1000.0F);
  const Linearisation at = objective.linearise(off, 1.0F);
  EXPECT_NEAR(at.cost, 52.0, 1e-9);
  EXPECT_NEAR(at.gradient[0], 40.0, 1e-9);
  EXPECT_NEAR(at.gradient[1], 20.0, 1e-9);
  EXPECT_NEAR(at.gradient[2], 8.0, 1e-9);
  EXPECT_EQ(at.curvature, (std::array<double, 6>{20.0, 0.0, 0.0, 20.0, 0.0, 16.0}));
  cost_with(20.0F);
  const Linearisation beyond = objective.linearise(off, 1.0F);
  EXPECT_NEAR(beyond.cost, 22.0, 1e-9);
  EXPECT_EQ(beyond.gradient[0], 0.0);
  EXPECT_EQ(beyond.gradient[1], 0.0);
  EXPECT_NEAR(beyond.gradient[2], 8.0, 1e-9);
  cost_with(1.0F);
  EXPECT_EQ(objective.linearise(off, 1.0F).gradient[2], 0.0);
  EXPECT_EQ(objective.linearise(off, 1.0F).curvature[5], 0.0);
}

TEST_F(SmallMap, PosesAreCountedFromTheAnchor) {
  add({{0.51, 0.51}});
  Objective objective(map_, Interpolation::kBilinear, CostForm::kDistance);
  objective.set_anchor({10, -20});
  const CellPose pose = objective.to_cells({1.0, -0.5, 4.0});
  EXPECT_NEAR(static_cast<double>(pose.x), 10.0, 1e-5);
  EXPECT_NEAR(static_cast<double>(pose.y), 10.0, 1e-5);
  EXPECT_NEAR(static_cast<double>(pose.theta), 4.0 - 2.0 * kPi, 1e-6);
  EXPECT_THAT(objective.to_metres(pose), PoseNear({1.0, -0.5, 4.0}, 1e-6, 1e-4));
}

// Each method heeds what the options say of it, and nothing of what they say of the others.
TEST_F(SmallMap, EachOptimizerHasItsOwnOptions) {
  std::vector<Point2> wall;
  for (int k = 0; k < 40; ++k) wall.emplace_back(0.5, kEdge_m * k);
  for (int k = 0; k < 40; ++k) wall.emplace_back(kEdge_m * k, 0.5);
  add(wall);
  const std::vector<PointCells> points = in_cells(wall, kEdge_m);
  Objective objective(map_, Interpolation::kBilinear, CostForm::kDistance);
  objective.set_cap(map_.cap());
  objective.set_points(points);
  const auto evaluations = [&](MatcherKind kind, const OptimizerConfig& options) {
    return minimise_in_box(objective, {1.5F, -1.0F, 0.02F}, {}, kind, options).evaluations;
  };
  const auto heeds = [&](MatcherKind kind) {
    const std::uint32_t usual = evaluations(kind, {});
    return std::array{evaluations(kind, {.particles = 7}) != usual, evaluations(kind, {.complexes = 2}) != usual,
                      evaluations(kind, {.moves = 5}) != usual, evaluations(kind, {.cooling = 8.0}) != usual};
  };
  EXPECT_EQ(heeds(MatcherKind::kPso), (std::array{true, false, false, false}));
  EXPECT_EQ(heeds(MatcherKind::kSce), (std::array{false, true, false, false}));
  EXPECT_EQ(heeds(MatcherKind::kSimpsa), (std::array{false, false, true, true}));
}

TEST(SearchWindow, HasASampleInItsMiddleAndAsManyToEachSide) {
  const auto counts = [](float half_cells, float half_rad) {
    const SearchWindow window{.centre = {}, .half_xy_cells = half_cells, .half_theta_rad = half_rad, .step_rad = 0.25F};
    return std::pair{window.count_xy(), window.count_theta()};
  };
  EXPECT_EQ(counts(3.0F, 0.5F), (std::pair{7U, 5U}));
  EXPECT_EQ(counts(2.5F, 0.3F), (std::pair{7U, 5U}));
  EXPECT_EQ(counts(0.0F, 0.0F), (std::pair{1U, 1U}));
}

TEST(SearchWindow, HoldsItsEdgesAndAnEdgeIsHalfAStepWide) {
  const SearchWindow window{
      .centre = {10.0F, 20.0F, 0.5F}, .half_xy_cells = 4.0F, .half_theta_rad = 0.5F, .step_rad = 0.25F};
  for (const float side : {-1.0F, 1.0F}) {
    const auto held = [&](float dx, float dy, float dt) {
      return window.holds({10.0F + side * dx, 20.0F + side * dy, 0.5F + side * dt});
    };
    EXPECT_TRUE(held(4.0F, 4.0F, 0.5F));
    EXPECT_FALSE(held(4.125F, 0.0F, 0.0F));
    EXPECT_FALSE(held(0.0F, 4.125F, 0.0F));
    EXPECT_FALSE(held(0.0F, 0.0F, 0.5625F));
    const auto at_edge = [&](float dx, float dy, float dt) {
      return window.has_at_edge({10.0F + side * dx, 20.0F + side * dy, 0.5F + side * dt});
    };
    EXPECT_FALSE(at_edge(3.5F, 3.5F, 0.375F));
    EXPECT_TRUE(at_edge(3.625F, 0.0F, 0.0F));
    EXPECT_TRUE(at_edge(0.0F, 3.625F, 0.0F));
    EXPECT_TRUE(at_edge(0.0F, 0.0F, 0.40625F));
  }
  EXPECT_FALSE((SearchWindow{.centre = {}, .half_xy_cells = 0.0F, .half_theta_rad = 0.5F}).has_at_edge({9.0F, 0, 0}));
  EXPECT_FALSE((SearchWindow{.centre = {}, .half_xy_cells = 4.0F, .half_theta_rad = 0.0F}).has_at_edge({9.0F, 0, 0}));
}

}  // namespace
}  // namespace gdtslam
