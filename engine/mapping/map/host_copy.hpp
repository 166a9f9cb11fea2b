// The map's copy on the host, for devices whose memory the host does not see: a field and the keyframes that it does
// not hold yet. The kernels that replay them are those of the CPU backend, so copy and device hold the same bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/edt/edt.hpp"
#include "gdtslam/mapping/global_field.hpp"

namespace gdtslam {

/// The cells of a field (rows of grid_stride()) of one box as the field of another; the cap where the first has none.
std::vector<std::uint16_t> moved_cells(const std::vector<std::uint16_t>& cells, const CellBox& from, const CellBox& to,
                                       std::uint16_t cap);

class GlobalField::HostCopy {
 public:
  HostCopy(std::uint32_t radius_cells, DistanceTransform transform);

  /// Notes a keyframe that is about to be merged.
  void note(const KeyframeCells& keyframe, const MergeStep& step) { journal_.push_back({keyframe, step}); }
  /// Keyframes noted but not in the copy.
  [[nodiscard]] std::size_t journal_length() const { return journal_.size(); }
  /// Keyframes noted so far.
  [[nodiscard]] std::uint64_t keyframes() const { return held_ + journal_.size(); }

  /// The field of `box` (map cells, which holds all keyframes) with every keyframe noted so far.
  const std::vector<std::uint16_t>& cells(const CellBox& box, Isa isa);
  /// Takes over a field of `box` that holds the first `keyframes` ones; a field older than the copy is left.
  void adopt(const CellBox& box, std::vector<std::uint16_t> cells, std::uint64_t keyframes);

 private:
  struct Entry {
    KeyframeCells keyframe;
    MergeStep step;
  };

  void merge(const Entry& entry, Isa isa);
  // From the seeds to the squared distances of a window.
  void transform(const EdtColumns::Params& grid, Isa isa);

  std::uint32_t radius_;
  DistanceTransform transform_;
  std::vector<std::uint16_t> table_;
  CellBox box_{};
  std::vector<std::uint16_t> cells_;
  std::uint64_t held_ = 0;  // keyframes in the copy
  std::deque<Entry> journal_;
  std::vector<std::uint8_t> seeds_;
  std::vector<std::uint8_t> column_distance_;
  std::vector<std::uint32_t> nearest_[2];
  std::vector<std::uint16_t> squared_distance_;
  std::vector<std::uint16_t> field_;
};

}  // namespace gdtslam
