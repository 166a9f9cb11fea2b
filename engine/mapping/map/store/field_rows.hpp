// The cells of a map on a device, in rows of one rectangle; growing copies it there.
#pragma once

#include "field_store.hpp"

namespace gdtslam {

class FieldRows final : public FieldStore {
 public:
  FieldRows(Backend& backend, std::uint16_t cap, std::uint64_t max_cells)
      : backend_(&backend), cap_(cap), max_cells_(max_cells) {}

  [[nodiscard]] bool can_hold(const CellBox& box) const override;
  [[nodiscard]] std::string limit() const override { return limit_of_option(max_cells_); }
  void hold(const GridBoxes& boxes) override;
  void touch(const CellBox& /*box*/) override {}
  [[nodiscard]] std::uint64_t untaken_cells(const CellBox& /*box*/) const override { return 0; }
  [[nodiscard]] std::uint64_t taken_cells() const override;
  [[nodiscard]] std::vector<std::uint16_t> read() const override;
  void write(const CellRows& from) override;

 private:
  [[nodiscard]] Buffer allocate_for(const CellBox& box) const;
  void copy_into(const Buffer& target, const CellBox& box) const;

  Backend* backend_;
  std::uint16_t cap_;
  std::uint64_t max_cells_;
};

}  // namespace gdtslam
