// The cells of a map on the CPU, in strips of 64 columns (kernel_options.hpp) within a piece of address space that is
// larger than the map: the system gives the pages that are touched, zero, which means unknown. Where a map leaves its
// piece, or the process may not have so much address space, the tiles that are known move to a larger one.
#pragma once

#include "field_store.hpp"

namespace gdtslam {

class FieldStrips final : public FieldStore {
 public:
  FieldStrips(Backend& backend, std::uint16_t cap) : backend_(&backend) { layout_.blank = cap; }

  [[nodiscard]] bool can_hold(const CellBox& box) const override;
  [[nodiscard]] std::string limit() const override;
  void hold(const CellBox& content, const CellBox& box) override;
  void touch(const CellBox& box) override;
  [[nodiscard]] std::uint64_t untaken_cells(const CellBox& box) const override;
  [[nodiscard]] std::uint64_t taken_cells() const override;
  [[nodiscard]] std::vector<std::uint16_t> read() const override;
  void write(const CellRows& from) override;
  /// Not on the CPU: throws std::logic_error.
  [[nodiscard]] Buffer snapshot() const override;

 private:
  void move_to(const CellBox& tiles, Buffer buffer);
  [[nodiscard]] std::size_t tile_of(CellIndex tile) const;
  template <class See>
  void for_each_tile(const CellBox& box, See see) const;
  void write_piece(CellIndex first, std::span<const std::uint16_t> cells);

  Backend* backend_;
  CellBox box_{};
  CellBox tiles_{};             // of 64 x 64 cells that the piece of address space holds
  std::vector<bool> is_known_;  // by tile, strip by strip
  std::uint64_t known_ = 0;     // tiles
};

}  // namespace gdtslam
