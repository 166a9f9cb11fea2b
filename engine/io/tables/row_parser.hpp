// Parses a line of a table to its values. Thread-safe, but a CsvRows belongs to one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "table_row.hpp"

namespace gdtslam {

using RowWarn = std::function<void(std::string_view kind, std::string_view detail)>;

/// A JSON object with only arrays of numbers nested in it. Accepts NaN and Infinity, which Python writes. Throws
/// MalformedRow.
void parse_json_row(std::string_view line, TableRow& row, const RowWarn& warn);

/// Rows of CSV (RFC 4180, one line each); the first line names the columns.
class CsvRows {
 public:
  /// False for the header, which is no row. Throws MalformedRow; nothing can be read after a wrong header.
  bool parse(std::string_view line, TableRow& row, const RowWarn& warn);
  [[nodiscard]] bool wants_header() const { return columns_.empty(); }

 private:
  enum class Member : std::uint8_t { kRange, kCoordinate };  ///< r0, r1, ...; x0, y0, x1, ...
  struct Unused {};
  struct Column {
    std::string name;
    std::variant<Unused, TableNumber, TableList, TableText, Member> meaning;
  };
  void read_header(std::string_view line, const RowWarn& warn);
  Column make_column(const std::string& name, const RowWarn& warn);
  /// The next cell, without its quotes. False at the end of the line.
  bool next_cell(std::string_view& rest, std::string& cell) const;
  void take(const Column& column, const std::string& cell, TableRow& row) const;

  std::vector<Column> columns_;
  std::size_t ranges_ = 0;       ///< columns r0, r1, ... so far
  std::size_t coordinates_ = 0;  ///< columns x0, y0, ... so far
};

/// Appends numbers separated by blanks, commas, semicolons or brackets. Throws MalformedRow.
void append_listed_numbers(std::string_view text, std::string_view column, std::vector<double>& numbers);

}  // namespace gdtslam
