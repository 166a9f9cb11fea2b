// Rows of CSV (RFC 4180, one line each): the first names the columns. One object belongs to one thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "row_parser.hpp"

namespace gdtslam {

class CsvRows final : public RowParser {
 public:
  bool parse(std::string_view line, TableRow& row, const Warn& warn) override;
  [[nodiscard]] bool wants_header() const override { return columns_.empty(); }
  [[nodiscard]] bool can_hide_cut() const override { return true; }
  [[nodiscard]] std::string_view kind() const override { return "a CSV file"; }

 private:
  enum class Member : std::uint8_t { kRange, kCoordinate };  ///< r0, r1, ...; x0, y0, x1, ...
  struct Unused {};
  struct Column {
    std::string name;
    std::variant<Unused, TableNumber, TableList, TableText, Member> meaning;
  };
  void read_header(std::string_view line, const Warn& warn);
  Column column_of(const std::string& name, const Warn& warn);
  /// The next cell, without its quotes. False at the end of the line.
  bool next_cell(std::string_view& rest, std::string& cell) const;
  void take(const Column& column, const std::string& cell, TableRow& row) const;

  std::vector<Column> columns_;
  std::size_t ranges_ = 0;       ///< columns r0, r1, ... so far
  std::size_t coordinates_ = 0;  ///< columns x0, y0, ... so far
};

/// Numbers with blanks, commas, semicolons or brackets between them, appended. Throws MalformedRow.
void append_listed_numbers(std::string_view text, std::string_view column, std::vector<double>& numbers);

}  // namespace gdtslam
