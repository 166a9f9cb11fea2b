#include "scan_marks.hpp"

#include <algorithm>
#include <cstdlib>

namespace gdtslam {
namespace {

constexpr std::int64_t kSubCells = 512;  // half steps of 1/256 cell
constexpr unsigned kTileBits = 6;        // bits of a cell's place in its tile
constexpr std::int64_t kWithin = kTileSide - 1;

// Bits of the cells from first to last in a line of a tile.
std::uint64_t bit_range(std::int64_t first, std::int64_t last) {
  return (~std::uint64_t{0} << (first & kWithin)) & (~std::uint64_t{0} >> (~last & kWithin));
}

/// A segment along one axis; cells are counted from the lower left tile.
struct Along {
  Along(std::int64_t start, std::int64_t end)
      : run(std::abs(end - start)),
        border(end < start ? start & (kSubCells - 1) : kSubCells - (start & (kSubCells - 1))),
        cell(start / kSubCells),
        cells(std::abs(end / kSubCells - start / kSubCells)),
        step(end < start ? -1 : 1) {}
  std::int64_t run;
  std::int64_t border;  ///< from the start to the first border of a cell
  std::int64_t cell;    ///< cell of the start
  std::int64_t cells;   ///< borders crossed
  std::int64_t step;
};

/// Finds where a segment leaves one row of cells after the other, or one column. The border k between rows is crossed
/// after n borders between columns:
///   n = ceil(((border_across + 512 k) run_along - border_along run_across) / (512 run_across)).
/// At a corner the border between rows comes first. There is no branch, because no processor could predict it.
template <bool kForward>
class Crossings {
 public:
  Crossings(const Along& along, const Along& across, bool columns_first)
      : whole_(kSubCells * across.run),
        each_(along.run / across.run + 1),
        beyond_(kSubCells * (along.run - each_ * across.run)) {
    const std::int64_t ahead = across.border * along.run - along.border * across.run + (columns_first ? 1 : 0);
    const std::int64_t passed = ahead > 0 ? (ahead - 1) / whole_ + 1 : 0;
    at_ = kForward ? along.cell + passed : along.cell - passed;
    past_ = ahead - 1 - (passed - 1) * whole_;
  }
  /// The last cell of the row.
  [[nodiscard]] std::int64_t at() const { return at_; }
  void next() {
    past_ += beyond_;
    const std::int64_t one_less = past_ >> 63U;  // all bits, or none
    past_ += whole_ & one_less;
    kForward ? at_ += each_ + one_less : at_ -= each_ + one_less;
  }

 private:
  std::int64_t whole_;
  std::int64_t each_;    ///< most columns passed in a row,
  std::int64_t beyond_;  ///< and the exact number minus that, below 0
  std::int64_t at_ = 0;
  std::int64_t past_ = 0;  ///< distance beyond the last border, less than `whole_`
};

}  // namespace

struct ScanMarks::Segment {
  Along x;
  Along y;
};

void ScanMarks::clear(const CellBox& box) {
  for (std::size_t k = 0; k < used_; ++k) {
    pool_[k]->rows.fill(0);
    pool_[k]->columns.fill(0);
    pool_[k]->ends.fill(0);
  }
  used_ = 0;
  const CellIndex low = cell_tile(box.min);
  const CellIndex high = cell_tile(box.end - CellOffset{1, 1});
  origin_ = {low.x * kTileSide, low.y * kTileSide};
  columns_ = static_cast<std::size_t>(high.x - low.x) + 1;
  places_.assign(columns_ * (static_cast<std::size_t>(high.y - low.y) + 1), nullptr);
}

ScanMarks::Tile& ScanMarks::new_tile(std::int64_t column, std::int64_t row) {
  if (used_ == pool_.size()) pool_.push_back(std::make_unique<Tile>());
  Tile& tile = *pool_[used_++];
  tile.place = cell_tile(origin_) + CellOffset{static_cast<std::int32_t>(column), static_cast<std::int32_t>(row)};
  return tile;
}

void ScanMarks::add_end(CellIndex cell) {
  const CellOffset at = cell - origin_;
  tile_at(at.dx >> 6, at.dy >> 6).ends[static_cast<std::size_t>(at.dy & (kTileSide - 1))] |=
      std::uint64_t{1} << (at.dx & (kTileSide - 1));
}

// Marks the cells of a row, or of a column, between two positions counted from the origin.
template <bool kAlongX>
void ScanMarks::mark_run(std::int64_t line, std::int64_t from, std::int64_t to) {
  const std::int64_t last = std::max(from, to);
  for (std::int64_t at = std::min(from, to); at <= last; at = (at | kWithin) + 1) {
    tile_lines<kAlongX>(at, line)[static_cast<std::size_t>(line & kWithin)] |=
        bit_range(at, std::min(last, at | kWithin));
  }
}

// The lines of the tile that holds a cell.
template <bool kAlongX>
TileBits& ScanMarks::tile_lines(std::int64_t along, std::int64_t across) {
  return kAlongX ? tile_at(along >> kTileBits, across >> kTileBits).rows
                 : tile_at(across >> kTileBits, along >> kTileBits).columns;
}

// Each step is a row (or column), from the segment's entry to its exit; mostly both lie in the tile of the row before.
template <bool kAlongX, bool kForward>
void ScanMarks::cast(const Segment& segment) {
  const Along along = kAlongX ? segment.x : segment.y;
  const Along across = kAlongX ? segment.y : segment.x;
  const std::int64_t step = across.step;
  const std::int64_t last = across.cell + step * across.cells;
  std::int64_t entered = along.cell;
  if (across.cells > 0) {
    Crossings<kForward> crossings(along, across, !kAlongX);
    for (std::int64_t line = across.cell; line != last;) {
      const std::int64_t border = step > 0 ? (line | kWithin) + 1 : (line & ~kWithin) - 1;
      const std::int64_t end = step > 0 ? std::min(border, last) : std::max(border, last);
      std::uint64_t* words = tile_lines<kAlongX>(entered, line).data();
      for (; line != end; line += step, crossings.next()) {
        const std::int64_t left = crossings.at();
        if ((entered ^ left) <= kWithin) {
          words[line & kWithin] |= kForward ? bit_range(entered, left) : bit_range(left, entered);
        } else {
          mark_run<kAlongX>(line, entered, left);
          words = tile_lines<kAlongX>(left, line).data();
        }
        entered = left;
      }
    }
  }
  mark_run<kAlongX>(last, entered, kForward ? along.cell + along.cells : along.cell - along.cells);
}

void ScanMarks::add_ray(const SubCell& start, const SubCell& end) {
  const std::int64_t left = std::int64_t{origin_.x} * kSubCells;
  const std::int64_t low = std::int64_t{origin_.y} * kSubCells;
  const Segment segment{{start.x - left, end.x - left}, {start.y - low, end.y - low}};
  if (segment.x.run >= segment.y.run) {
    segment.x.step > 0 ? cast<true, true>(segment) : cast<true, false>(segment);
  } else {
    segment.y.step > 0 ? cast<false, true>(segment) : cast<false, false>(segment);
  }
}

void transpose(TileBits& bits) {
  std::uint64_t mask = ~std::uint64_t{0} >> 32U;  // the lower half of each group of 2 x half bits
  for (std::size_t half = kTileSide / 2; half > 0; half /= 2, mask ^= mask << half) {
    for (std::size_t group = 0; group < bits.size(); group += 2 * half) {
      for (std::size_t k = group; k < group + half; ++k) {
        const std::uint64_t swapped = ((bits[k] >> half) ^ bits[k + half]) & mask;
        bits[k] ^= swapped << half;
        bits[k + half] ^= swapped;
      }
    }
  }
}

}  // namespace gdtslam
