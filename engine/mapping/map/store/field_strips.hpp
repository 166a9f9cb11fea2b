// The cells of a map on the CPU, in strips of 64 columns (kernel_options.hpp) within a piece of address space that is
// larger than the map: the system gives the pages that are touched, zero, which means unknown. Where a map leaves its
// piece, or the process may not have so much address space, the tiles that are known move to a larger one. A map that
// may be larger than that (keep_near) has a piece that follows the robot, and what is far from it waits on disk: then
// the time for a scan does not depend on how far the robot has gone.
#pragma once

#include <optional>

#include "block_shelf.hpp"
#include "field_store.hpp"

namespace gdtslam {

class FieldStrips final : public FieldStore {
 public:
  FieldStrips(Backend& backend, std::uint16_t cap) : backend_(&backend) { layout_.blank = cap; }

  [[nodiscard]] bool can_hold(const CellBox& box) const override;
  [[nodiscard]] std::string limit() const override;
  void hold(const CellBox& wanted, const GridBoxes& boxes) override;
  void keep_near(const std::string& folder) override;
  void come_near(const CellBox& box) override;
  void touch(const CellBox& box) override;
  [[nodiscard]] std::uint64_t untaken_cells(const CellBox& box) const override;
  [[nodiscard]] std::uint64_t taken_cells() const override;
  void read_row(CellIndex first, std::span<std::uint16_t> cells, std::uint16_t cap) const override;
  [[nodiscard]] bool is_whole() const override { return !shelf_ || shelf_->empty(); }
  [[nodiscard]] std::vector<std::uint16_t> read() const override;
  void write(const CellRows& from) override;
  /// Not on the CPU: throws std::logic_error.
  [[nodiscard]] Buffer snapshot() const override;

 private:
  void make_piece(const CellBox& tiles);
  void move_to(const CellBox& tiles, Buffer buffer);
  void repeat_first_cells(std::size_t block);
  void take_near(const CellBox& tiles);
  void put_away(std::size_t block);
  void put_far_away(const CellBox& tiles);
  [[nodiscard]] std::size_t tile_of(CellIndex tile) const;
  [[nodiscard]] BlockIndex index_of(std::size_t block) const;
  [[nodiscard]] CellBox tiles_of(std::size_t block) const;
  [[nodiscard]] std::span<std::uint16_t, kBlockCells> cells_of(std::size_t block) const;
  template <class See>
  void for_each_tile(const CellBox& box, See see) const;
  void write_piece(CellIndex first, std::span<const std::uint16_t> cells);

  Backend* backend_;
  CellBox box_{};
  CellBox tiles_{};             // of 64 x 64 cells that the piece of address space holds
  std::vector<TileSet> known_;  // in the piece, by block, strip by strip
  std::uint64_t here_ = 0;      // tiles that are known in the piece
  std::uint64_t taken_ = 0;     // tiles that are known here or on the shelf
  std::optional<BlockShelf> shelf_;
  CellBox near_{};        // tiles that were last asked for
  std::size_t next_ = 0;  // block that is looked at next for whether it may go
};

}  // namespace gdtslam
