// The cells of a map on the CPU, in strips of 64 columns (kernel_options.hpp) within a piece of address space that is
// larger than the map: the system gives the pages that are touched, zero, which means unknown. Where a map leaves its
// piece, or the process may not have so much address space, the tiles that are known move to a larger one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "field_store.hpp"

namespace gdtslam {

class FieldStrips final : public FieldStore {
 public:
  FieldStrips(Backend& backend, std::uint16_t cap) : backend_(&backend) { layout_.blank = cap; }

  [[nodiscard]] bool can_hold(const CellBox& box) const override;
  [[nodiscard]] std::string limit() const override;
  void hold(const GridBoxes& boxes) override;
  void touch(const CellBox& box) override;
  [[nodiscard]] std::uint64_t untaken_cells(const CellBox& box) const override;
  [[nodiscard]] std::uint64_t taken_cells() const override;
  [[nodiscard]] std::vector<std::uint16_t> read() const override;
  void write(const CellRows& from) override;

 private:
  void make_piece(const CellBox& tiles);
  void move_to(const CellBox& tiles, Buffer buffer);
  void repeat_first_cells(std::size_t tile);
  [[nodiscard]] std::size_t tile_index(CellIndex tile) const;
  template <class See>
  void for_each_tile(const CellBox& box, See see) const;
  void write_piece(CellIndex first, std::span<const std::uint16_t> cells);

  Backend* backend_;
  CellBox box_{};
  CellBox tiles_{};          // tiles of 64 x 64 cells that the piece of address space holds
  std::vector<bool> known_;  // a tile each, strip by strip
  std::uint64_t taken_ = 0;  // bytes taken of them
};

}  // namespace gdtslam
