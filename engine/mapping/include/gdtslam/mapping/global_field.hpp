// The map: the global distance transform (GDT), a field of 1/256 cell that grows with what is seen. Cells hold the
// distance to the nearest obstacle that scans agree on, the cap where nothing is known. Its two outermost rows and
// columns always hold the cap. Cell (0, 0) has fixed map coordinates: growing moves the origin by whole cells.
//
// The field lives on the device. Where the host does not share its memory, the host keeps a copy and a journal of the
// keyframes that the copy does not hold yet: every keyframe is written there before the device is asked for anything,
// so that what a lost device took along is known, and replaying it on the host gives the same bits. Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/compute/kernel_options.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {

/// How keyframes are merged, paper equations (9) to (11); 1/256 cell.
struct MergeStep {
  MergeRule rule = MergeRule::kWorking;
  std::uint32_t threshold = 0;
  std::uint32_t lift = 0;  ///< kappa * threshold
};

class GlobalField {
 public:
  /// Resolution in metres, truncation radius in cells, the most cells that the map may take, and the transform of the
  /// keyframes that are merged, for the host's copy.
  GlobalField(Backend& backend, double resolution_m, std::uint32_t radius_cells, std::uint64_t max_cells,
              DistanceTransform transform = DistanceTransform::kExact);
  GlobalField(const GlobalField&) = delete;
  GlobalField& operator=(const GlobalField&) = delete;
  ~GlobalField();

  /// Geometry of the stored grid; its origin is a whole number of cells from the map's origin.
  [[nodiscard]] GridGeometry geometry() const;
  [[nodiscard]] std::uint32_t stride() const { return stride_; }
  [[nodiscard]] std::uint32_t radius_cells() const { return radius_; }
  [[nodiscard]] std::uint16_t cap() const;
  /// Lower left cell in map cells (cell (0, 0) of the map frame has its lower left corner at the map's origin).
  [[nodiscard]] CellIndex first_cell() const { return box_.min; }
  /// The cells on the host, row-major, stride() from row to row, what lies between the rows unspecified; valid until
  /// the next grow or merge. Brings the host's copy up to date where there is one, and never asks the device.
  [[nodiscard]] std::span<const std::uint16_t> cells() const;
  /// Field value at a cell in map cells; the cap outside.
  [[nodiscard]] std::uint16_t at(CellIndex map_cell) const;
  /// The cells on the device.
  [[nodiscard]] const Buffer& buffer() const { return buffer_; }
  /// Whether the host sees the device's memory, so that no copy is kept.
  [[nodiscard]] bool shares_memory() const { return !shared_.empty(); }

  /// Makes the grid hold the box (map cells) and its guard. Throws InputError when it would pass max_cells.
  void grow_to_hold(const CellBox& map_box);
  /// Makes room for a keyframe and notes it for the host's copy; the caller then merges it on the device
  /// (LocalField::merge_into). Throws InputError as grow_to_hold() does, and then nothing has changed; a DeviceError
  /// leaves the keyframe in the journal.
  void add_keyframe(const KeyframeCells& keyframe, const MergeStep& step);

  /// Where the journal has become long: copies the field on the device, and asks for one piece of the copy after the
  /// other, behind the work in line; each is small, so that it needs no submission of its own.
  void continue_checkpoint();
  /// Takes the piece that was asked for, if one was; after the last forgets the keyframes that the copy holds.
  void take_checkpoint_piece();
  /// Keyframes that the host's copy does not hold yet.
  [[nodiscard]] std::size_t journal_length() const;

  /// The device's own cells, like cells(), the cap between the rows: to be compared with the copy.
  [[nodiscard]] std::vector<std::uint16_t> download_device_cells();

  /// Goes over to another backend with what the host knows; the one before is not asked for anything.
  void move_to(Backend& backend);
  /// Gives the device up; cells() still has the whole map.
  void leave_device();

 private:
  class HostCopy;
  // A state of the field on its way to the host.
  struct Checkpoint {
    Buffer snapshot;
    CellBox box;
    std::uint64_t keyframes = 0;  // that it holds
    std::vector<std::uint16_t> cells;
    std::size_t arrived = 0;  // cells
    std::optional<PendingDownload> under_way;
  };

  void start_checkpoint();
  void resize_to_hold(const CellBox& map_box);
  void resize_buffer();
  void copy_field(const Buffer& target) const;
  void look_for_shared_memory();

  Backend* backend_;
  Isa isa_;
  double resolution_m_;
  std::uint32_t radius_;
  std::uint64_t max_cells_;
  DistanceTransform transform_;
  CellBox content_{};  // map cells that have been asked for, their guard included
  CellBox box_{};      // map cells that are stored
  std::uint32_t stride_ = 0;
  Buffer buffer_;
  CellBox buffer_box_{};  // what the buffer holds; box_ but for the moment of growing
  std::span<const std::uint16_t> shared_;
  std::unique_ptr<HostCopy> copy_;
  std::optional<Checkpoint> checkpoint_;
};

}  // namespace gdtslam
