// Each rule of what is new and gone at and beside its limit: cells of a metre, and beams along rows that say what they
// are told to say.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/mapping/changes/map_changes.hpp"
#include "engine/mapping/changes/session_changes.hpp"
#include "engine/mapping/changes/view_counts.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using Cells = std::vector<CellIndex>;

/// A cell of these has four neighbours within the tolerance; patches may be one cell large.
constexpr ChangeLimits kLimits{.tolerance_m = 1.0, .spacing_m = 0.25, .patch_gap_m = 1.0};

/// Views of one beam each, along +x from the middle of column 0.
class RowViews {
 public:
  explicit RowViews(std::uint64_t max_cells = 1U << 24U)
      : views_({.rays = {.resolution_m = 1.0, .min_range_m = 0.1, .max_range_m = 200.0},
                .spacing_m = kLimits.spacing_m,
                .max_cells = max_cells}) {}
  /// So many times, from places far enough from each other, that end in this cell.
  void add(CellIndex end, int times) {
    for (int k = 0; k < times; ++k) {
      is_up_ = !is_up_;
      LaserScan scan;
      scan.ranges_m = {static_cast<float>(end.x)};
      EXPECT_TRUE(views_.add(scan, {0.5, end.y + (is_up_ ? 0.75 : 0.25), 0.0}));
    }
  }
  /// Through the cell and those above and below it, and on to where nobody asks.
  void pass(CellIndex cell, int times) {
    for (const std::int32_t dy : {-1, 0, 1}) add({kFar, cell.y + dy}, times);
  }
  [[nodiscard]] const ViewCounts& views() const { return views_; }
  [[nodiscard]] ViewCounts taken() && { return std::move(views_); }

 private:
  static constexpr std::int32_t kFar = 60;
  ViewCounts views_;
  bool is_up_ = false;
};

TEST(ViewCountsOfRows, CountEndsAndWhatWasPassed) {
  RowViews rows;
  rows.add({5, 3}, 2);
  rows.add({70, 3}, 1);
  rows.add({2, -1}, 1);
  EXPECT_EQ(rows.views().views(), 4U);
  EXPECT_EQ(rows.views().at({5, 3}).ends, 2U);
  EXPECT_EQ(rows.views().at({5, 3}).passes, 1U);
  EXPECT_EQ(rows.views().at({4, 3}).passes, 3U);
  EXPECT_EQ(rows.views().at({69, 3}).passes, 1U);
  EXPECT_EQ(rows.views().at({70, 3}).ends, 1U);
  EXPECT_EQ(rows.views().at({71, 3}).passes, 0U);
  EXPECT_EQ(rows.views().at({4, 4}).passes, 0U);
  EXPECT_EQ(rows.views().at({500, 500}).passes, 0U);
  EXPECT_EQ(rows.views().ended(), (Cells{{2, -1}, {5, 3}, {70, 3}})) << "tiles by rows";
  const Cells passed = rows.views().passed();
  EXPECT_EQ(passed.size(), 72U);
  EXPECT_EQ(passed.front(), (CellIndex{0, -1}));
  EXPECT_EQ(passed.back(), (CellIndex{69, 3}));
}

TEST(ViewCountsOfRows, AViewLiesAStepFromTheLastOne) {
  ViewCounts views({.rays = {.resolution_m = 1.0, .max_range_m = 10.0}, .spacing_m = 0.25});
  LaserScan scan;
  scan.ranges_m = {2.0F};
  EXPECT_TRUE(views.add(scan, {0.5, 0.25, 0.0}));
  EXPECT_FALSE(views.add(scan, {0.5, 0.4375, 0.0}));
  EXPECT_TRUE(views.add(scan, {0.5, 0.5, 0.0}));
  EXPECT_FALSE(views.add(scan, {0.5, 0.3125, 0.0}));
  scan.ranges_m = {20.0F};
  EXPECT_FALSE(views.add(scan, {0.5, 3.0, 0.0})) << "no beam says anything";
  EXPECT_EQ(views.views(), 2U);
}

// By whole tiles of 64 cells a side, each counted once however many views touch it.
TEST(ViewCountsOfRows, AreRefusedBeyondTheCellsThatAreAllowed) {
  RowViews rows(8192);
  rows.add({60, 3}, 3);
  rows.add({70, 3}, 3);
  EXPECT_THROW(rows.add({130, 3}, 1), InputError);
  EXPECT_THROW(rows.add({60, 70}, 1), InputError);
  rows.add({127, 63}, 1);
  EXPECT_EQ(rows.views().views(), 7U);
  RowViews(4096).add({60, 3}, 1);
  EXPECT_THROW(RowViews(4095).add({60, 3}, 1), InputError);
}

TEST(ViewJudge, SurroundingsAreTheCellsWithinTheTolerance) {
  const auto count = [](double tolerance_m) {
    ChangeLimits limits;
    limits.tolerance_m = tolerance_m;
    return ViewJudge(0.5, limits).surroundings().size();
  };
  EXPECT_EQ(count(0.49), 1U);
  EXPECT_EQ(count(0.5), 5U);
  EXPECT_EQ(count(0.7), 5U);
  EXPECT_EQ(count(0.71), 9U);
  EXPECT_EQ(count(1.0), 13U);
}

TEST(ViewJudge, AWallIsWhereEnoughAndMostEnded) {
  const ViewJudge judge(1.0, kLimits);
  EXPECT_TRUE(judge.is_wall({.ends = 6, .passes = 4}, 6)) << "three fifths";
  EXPECT_FALSE(judge.is_wall({.ends = 6, .passes = 5}, 6));
  EXPECT_FALSE(judge.is_wall({.ends = 6, .passes = 4}, 7));
  EXPECT_TRUE(judge.is_wall({.ends = 1, .passes = 0}, 0));
  EXPECT_FALSE(judge.is_wall({.ends = 0, .passes = 0}, 0));
}

TEST(ViewJudge, FreeIsWhereFivePassedAndAllAroundWasSeen) {
  const ViewJudge judge(1.0, kLimits);
  const CellIndex cell{5, 3};
  RowViews enough;
  enough.pass(cell, 5);
  EXPECT_TRUE(judge.is_free(enough.views(), cell));
  EXPECT_FALSE(judge.is_free(enough.views(), {5, 4})) << "nobody saw the row above";
  RowViews few;
  few.pass(cell, 4);
  EXPECT_FALSE(judge.is_free(few.views(), cell));
  RowViews grazed;
  grazed.add({60, 3}, 5);
  grazed.add({60, 2}, 1);
  grazed.add({60, 4}, 1);
  EXPECT_TRUE(judge.is_free(grazed.views(), cell)) << "around it one is enough";
}

// Three of twenty may have ended there, all around together.
TEST(ViewJudge, FreeIsWhereFewEndedAround) {
  const ViewJudge judge(1.0, kLimits);
  const CellIndex cell{5, 3};
  for (const int ends : {3, 4}) {
    RowViews rows;
    rows.pass(cell, 20 - ends);
    rows.add({6, 3}, ends - 1);
    rows.add({5, 4}, 1);
    rows.add({60, 3}, 1);
    ASSERT_EQ(rows.views().at(cell).passes, 20U);
    EXPECT_EQ(judge.is_free(rows.views(), cell), ends == 3);
  }
}

std::vector<ChangedCell> changed(const Cells& cells) {
  std::vector<ChangedCell> all;
  for (const CellIndex cell : cells) all.push_back({.cell = cell, .views = {}});
  return all;
}

Cells cells_of(const std::vector<ChangedCell>& cells) {
  Cells all;
  for (const ChangedCell& cell : cells) all.push_back(cell.cell);
  return all;
}

std::vector<std::uint32_t> patches_among(const Cells& cells, double gap_m, double least_m = 1.0) {
  std::vector<ChangedCell> kept = changed(cells);
  ChangeLimits limits = kLimits;
  limits.patch_gap_m = gap_m;
  limits.tolerance_m = least_m;
  keep_patches(kept, 1.0, limits);
  std::vector<std::uint32_t> patches;
  for (const ChangedCell& cell : kept) patches.push_back(cell.patch);
  return patches;
}

using Numbers = std::vector<std::uint32_t>;

TEST(Patches, ReachOverTheGapInEachDirection) {
  EXPECT_EQ(patches_among({{0, 0}, {3, 0}}, 3.9), (Numbers{0, 0}));
  EXPECT_EQ(patches_among({{0, 0}, {4, 0}}, 3.9), (Numbers{0, 1}));
  EXPECT_EQ(patches_among({{0, 0}, {0, 3}}, 3.0), (Numbers{0, 0}));
  EXPECT_EQ(patches_among({{0, 0}, {0, 4}}, 3.0), (Numbers{0, 1}));
  EXPECT_EQ(patches_among({{3, 3}, {0, 0}}, 3.0), (Numbers{0, 0}));
  EXPECT_EQ(patches_among({{0, 3}, {3, 0}}, 3.0), (Numbers{0, 0}));
  EXPECT_EQ(patches_among({{0, 0}, {1, 0}}, 0.2), (Numbers{0, 0})) << "a cell at least";
  // From one to the next, backwards too: the last cell joins the others.
  EXPECT_EQ(patches_among({{0, 0}, {6, 0}, {3, 1}}, 3.0), (Numbers{0, 0, 0}));
}

TEST(Patches, SmallerThanTheToleranceAreLeftOut) {
  EXPECT_EQ(patches_among({{0, 0}, {9, 0}, {11, 0}, {20, 0}, {20, 1}, {20, 2}}, 2.0, 3.0), (Numbers{0, 0, 1, 1, 1}));
  EXPECT_EQ(patches_among({{9, 0}, {10, 0}}, 2.0, 3.0), Numbers{}) << "two cells wide";
  std::vector<ChangedCell> cells = changed({{20, 2}, {9, 0}, {20, 0}, {20, 1}, {11, 0}});
  ChangeLimits limits = kLimits;
  limits.patch_gap_m = 2.0;
  keep_patches(cells, 1.0, limits);
  EXPECT_EQ(cells_of(cells), (Cells{{9, 0}, {11, 0}, {20, 0}, {20, 1}, {20, 2}})) << "by rows";
  EXPECT_EQ(patches_of(cells), 2U);
  EXPECT_EQ(patches_of({}), 0U);
}

/// 40 cells by 12 that are free.
class OpenMap {
 public:
  OpenMap() {
    map_.geometry = {.resolution_m = 1.0, .width = 40, .height = 12};
    map_.cells = CellStates(map_.geometry.cell_count());
    for (std::size_t k = 0; k < map_.geometry.cell_count(); ++k) map_.cells.set(k, CellState::kFree);
  }
  OpenMap& set(CellIndex cell, CellState state) {
    map_.cells.set(static_cast<std::size_t>(cell.y) * 40 + static_cast<std::size_t>(cell.x), state);
    return *this;
  }
  [[nodiscard]] MapChanges changes(const RowViews& rows, const RowViews* before = nullptr) const {
    return find_changes(map_, rows.views(), before != nullptr ? &before->views() : nullptr, kLimits);
  }

 private:
  OccupancyMap map_;
};

RowViews ended(CellIndex cell, int times) {
  RowViews rows;
  rows.add(cell, times);
  return rows;
}

TEST(FindChanges, FiveEndsAreNewAndTwoBesideThem) {
  EXPECT_EQ(cells_of(OpenMap().changes(ended({10, 5}, 5)).appeared), (Cells{{10, 5}}));
  EXPECT_TRUE(OpenMap().changes(ended({10, 5}, 4)).empty());
  for (const int beside : {1, 2}) {
    RowViews rows = ended({10, 5}, 5);
    rows.add({10, 6}, beside);
    rows.add({10, 8}, 2);  // by themselves
    const Cells expected = beside == 2 ? Cells{{10, 5}, {10, 6}} : Cells{{10, 5}};
    EXPECT_EQ(cells_of(OpenMap().changes(rows).appeared), expected);
  }
}

TEST(FindChanges, NewIsOnlyWhatStandsInTheOpen) {
  const RowViews rows = ended({10, 5}, 5);
  const auto is_new = [&](const OpenMap& map) { return !map.changes(rows).appeared.empty(); };
  EXPECT_FALSE(is_new(OpenMap().set({10, 5}, CellState::kUnknown)));
  EXPECT_FALSE(is_new(OpenMap().set({10, 5}, CellState::kOccupied)));
  EXPECT_FALSE(is_new(OpenMap().set({11, 5}, CellState::kOccupied)));
  EXPECT_TRUE(is_new(OpenMap().set({11, 6}, CellState::kOccupied))) << "farther than the tolerance";
  EXPECT_TRUE(is_new(OpenMap().set({10, 6}, CellState::kUnknown))) << "four of five cells are free";
  EXPECT_FALSE(is_new(OpenMap().set({10, 6}, CellState::kUnknown).set({10, 4}, CellState::kUnknown)));
  EXPECT_TRUE(OpenMap().changes(ended({50, 5}, 5)).empty()) << "beyond the map";
}

TEST(FindChanges, GoneIsAWallThatFivePassed) {
  const CellIndex cell{10, 5};
  RowViews five;
  five.pass(cell, 5);
  RowViews four;
  four.pass(cell, 4);
  OpenMap map;
  map.set(cell, CellState::kOccupied);
  EXPECT_EQ(cells_of(map.changes(five).gone), (Cells{cell}));
  EXPECT_TRUE(map.changes(four).empty());
  EXPECT_TRUE(OpenMap().changes(five).empty()) << "there was no wall";
}

TEST(FindChanges, WhatWasSeenBeforeMustSpeakForIt) {
  const CellIndex cell{10, 5};
  const RowViews now = ended(cell, 5);
  RowViews seen_free;
  seen_free.pass(cell, 5);
  RowViews hardly_seen;
  hardly_seen.pass(cell, 4);
  EXPECT_FALSE(OpenMap().changes(now, &seen_free).appeared.empty());
  EXPECT_TRUE(OpenMap().changes(now, &hardly_seen).appeared.empty());
  OpenMap map;
  map.set(cell, CellState::kOccupied);
  const RowViews two_ends = ended(cell, 2);
  const RowViews one_end = ended(cell, 1);
  EXPECT_FALSE(map.changes(seen_free, &two_ends).gone.empty());
  EXPECT_TRUE(map.changes(seen_free, &one_end).gone.empty());
}

constexpr CellIndex kCell{10, 5};

DriveViews that_ended(int times, double first_s, double last_s) {
  return {ended(kCell, times).taken(), first_s, last_s};
}

DriveViews that_passed(double first_s, double last_s) {
  RowViews rows;
  rows.pass(kCell, 5);
  return {std::move(rows).taken(), first_s, last_s};
}

SessionChanges changes_between(DriveViews a, DriveViews b) {
  std::vector<DriveViews> drives;
  drives.push_back(std::move(a));
  drives.push_back(std::move(b));
  return {drives, 1.0, kLimits};
}

TEST(ChangesBetweenDrives, ALaterDriveSeesWhatIsGone) {
  const SessionChanges found = changes_between(that_ended(5, 0.0, 10.0), that_passed(11.0, 20.0));
  EXPECT_TRUE(found.by_drive()[0].empty());
  EXPECT_EQ(cells_of(found.by_drive()[1].gone), (Cells{kCell}));
  EXPECT_TRUE(found.by_drive()[1].appeared.empty());
  EXPECT_EQ(cells_of(found.last().gone), (Cells{kCell}));
  EXPECT_TRUE(found.last().appeared.empty());
  EXPECT_TRUE(found.is_overruled(0, kCell));
  EXPECT_FALSE(found.is_overruled(1, kCell)) << "by itself";
  EXPECT_FALSE(found.is_overruled(0, {10, 7}));
}

// Where one ends as the other begins neither is the later one.
TEST(ChangesBetweenDrives, ThatTouchHaveNoOrder) {
  const SessionChanges found = changes_between(that_ended(5, 0.0, 10.0), that_passed(10.0, 20.0));
  EXPECT_EQ(cells_of(found.by_drive()[0].appeared), (Cells{kCell}));
  EXPECT_EQ(cells_of(found.by_drive()[1].gone), (Cells{kCell}));
  EXPECT_EQ(cells_of(found.last().gone), (Cells{kCell})) << "contradicted it is no wall";
  EXPECT_TRUE(found.last().appeared.empty());
}

TEST(ChangesBetweenDrives, NewIsWhatEnoughViewsEndedIn) {
  const SessionChanges five = changes_between(that_passed(0.0, 10.0), that_ended(5, 11.0, 20.0));
  EXPECT_TRUE(five.by_drive()[0].empty());
  EXPECT_EQ(cells_of(five.by_drive()[1].appeared), (Cells{kCell}));
  EXPECT_EQ(cells_of(five.last().appeared), (Cells{kCell}));
  EXPECT_TRUE(five.last().gone.empty());
  EXPECT_FALSE(five.is_overruled(0, kCell));
  const SessionChanges four = changes_between(that_passed(0.0, 10.0), that_ended(4, 11.0, 20.0));
  EXPECT_TRUE(four.by_drive()[1].empty());
  EXPECT_TRUE(four.last().empty());
}

TEST(ChangesBetweenDrives, OneThatSaysTooLittleOverrulesNothing) {
  const SessionChanges once = changes_between(that_ended(1, 0.0, 10.0), that_passed(11.0, 20.0));
  EXPECT_TRUE(once.last().empty()) << "one end is no wall";
  const SessionChanges twice = changes_between(that_ended(2, 0.0, 10.0), that_passed(11.0, 20.0));
  EXPECT_EQ(cells_of(twice.last().gone), (Cells{kCell}));
}

}  // namespace
}  // namespace gdtslam
