// A line of a table to what it says. One object belongs to one thread.
#pragma once

#include <functional>
#include <string_view>

#include "table_row.hpp"

namespace gdtslam {

class RowParser {
 public:
  using Warn = std::function<void(std::string_view kind, std::string_view detail)>;
  RowParser() = default;
  RowParser(const RowParser&) = delete;
  RowParser& operator=(const RowParser&) = delete;
  virtual ~RowParser() = default;
  /// False where the line has no row: it is the header. Throws MalformedRow; one with a wrong header cannot go on.
  virtual bool parse(std::string_view line, TableRow& row, const Warn& warn) = 0;
  /// True while nothing makes sense without this line.
  [[nodiscard]] virtual bool wants_header() const = 0;
  /// True where a line that was cut off could still be taken for a whole one.
  [[nodiscard]] virtual bool can_hide_cut() const = 0;
  /// "a CSV file", for messages.
  [[nodiscard]] virtual std::string_view kind() const = 0;
};

}  // namespace gdtslam
