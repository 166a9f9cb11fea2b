// JSON lines: one object each, not nested but for its arrays. NaN and Infinity are taken too, as Python writes them.
// One object belongs to one thread.
#pragma once

#include <string_view>

#include "row_parser.hpp"

namespace gdtslam {

class JsonRows final : public RowParser {
 public:
  bool parse(std::string_view line, TableRow& row, const Warn& warn) override;
  [[nodiscard]] bool wants_header() const override { return false; }
  [[nodiscard]] bool can_hide_cut() const override { return false; }
  [[nodiscard]] std::string_view kind() const override { return "a file of JSON lines"; }
};

}  // namespace gdtslam
