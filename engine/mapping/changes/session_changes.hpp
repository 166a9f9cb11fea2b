// Changes between drives in one frame: a drive overrules earlier ones, cell by cell, if it has enough views. Two drives
// that overlap in time have no order: if they contradict each other, there is no wall. Frame: the cells of one grid,
// cell (0, 0) with its lower left corner at the frame's origin. Thread-safe once made; O(cells seen x drives).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/mapping/changes/map_changes.hpp"

namespace gdtslam {

/// A drive as input for changes.
struct DriveViews {
  ViewCounts views;
  double first_s = 0.0;  ///< stamps
  double last_s = 0.0;
};

class SessionChanges {
 public:
  /// `drives` in any order; only read during construction.
  SessionChanges(const std::vector<DriveViews>& drives, double resolution_m, const ChangeLimits& limits);

  /// Cells that each drive shows to be new or gone since the drives before it, and against those without an order.
  [[nodiscard]] const std::vector<MapChanges>& by_drive() const { return by_drive_; }
  /// True if the wall that the drive saw in the cell is gone.
  [[nodiscard]] bool is_overruled(std::size_t drive, CellIndex cell) const;
  /// Final changes: walls that earlier drives saw as free, and cells that are no wall any more.
  [[nodiscard]] const MapChanges& last() const { return last_; }

 private:
  enum class Word : std::uint8_t { kNone, kFree, kWall };
  struct Overruling {
    CellIndex cell;
    std::size_t by = 0;  ///< a drive after which no drive saw a wall there
  };
  [[nodiscard]] bool is_before(std::size_t a, std::size_t b) const;
  [[nodiscard]] std::vector<Word> collect_words(CellIndex cell) const;
  [[nodiscard]] std::vector<std::size_t> find_last_words(const std::vector<Word>& words) const;
  [[nodiscard]] bool is_strong(std::size_t drive, CellIndex cell) const;
  void judge(CellIndex cell);
  void overrule_around_what_is_gone();

  struct Lasted {
    double first_s = 0.0;
    double last_s = 0.0;
  };
  const std::vector<DriveViews>* drives_;  // only during construction
  std::vector<Lasted> order_;
  double resolution_m_;
  ChangeLimits limits_;
  ViewJudge judge_;
  std::vector<MapChanges> by_drive_;
  MapChanges last_;
  std::vector<Overruling> overruled_;  // by rows, then columns
};

}  // namespace gdtslam
