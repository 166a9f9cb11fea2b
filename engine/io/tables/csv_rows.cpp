#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "engine/core/ascii.hpp"
#include "engine/io/decimal.hpp"
#include "engine/io/message_text.hpp"
#include "row_parser.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kBlanks = " \t\r";
constexpr std::string_view kListSeparators = " \t\r,;[]()";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

}  // namespace

void append_listed_numbers(std::string_view text, std::string_view column, std::vector<double>& numbers) {
  const char* position = text.data();
  const char* const end = position + text.size();
  const auto is_between = [](char c) { return kListSeparators.find(c) != std::string_view::npos; };
  while (true) {
    position = std::find_if_not(position, end, is_between);
    if (position == end) return;
    double value = 0.0;
    const char* const stop = parse_double(position, end, value);
    if (stop == nullptr || (stop != end && !is_between(*stop))) {
      const char* const word_end = std::find_if(position, end, is_between);
      const std::string_view word(position, static_cast<std::size_t>(word_end - position));
      if (word == "none" && numbers.empty()) return;
      throw MalformedRow(fmt::format("has {} among its {}, which is not a number", in_quotes(word), column));
    }
    numbers.push_back(value);
    position = stop;
  }
}

bool CsvRows::next_cell(std::string_view& rest, std::string& cell) const {
  cell.clear();
  if (rest.data() == nullptr) return false;
  const std::size_t begin = std::min(rest.find_first_not_of(kBlanks), rest.size());
  if (begin < rest.size() && rest[begin] == '"') {
    std::size_t at = begin + 1;
    for (; at < rest.size(); ++at) {
      if (rest[at] != '"') {
        cell += rest[at];
      } else if (at + 1 < rest.size() && rest[at + 1] == '"') {
        cell += rest[at++];
      } else {
        break;
      }
    }
    if (at >= rest.size()) throw MalformedRow("opens a quotation mark that its line does not close");
    rest.remove_prefix(at + 1);
    const std::size_t comma = rest.find(',');
    if (!trimmed(rest.substr(0, comma)).empty()) throw MalformedRow("goes on behind a closing quotation mark");
    rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
    return true;
  }
  const std::size_t comma = rest.find(',');
  cell = trimmed(rest.substr(0, comma));
  rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
  return true;
}

CsvRows::Column CsvRows::make_column(const std::string& name, const RowWarn& warn) {
  if (const auto number = table_number(name)) return {name, *number};
  if (const auto list = table_list(name)) return {name, *list};
  if (const auto text = table_text(name)) return {name, *text};
  if (name == fmt::format("r{}", ranges_)) {
    ++ranges_;
    return {name, Member::kRange};
  }
  if (name == fmt::format("{}{}", coordinates_ % 2 == 0 ? 'x' : 'y', coordinates_ / 2)) {
    ++coordinates_;
    return {name, Member::kCoordinate};
  }
  if (const std::string hint = table_hint(name); !hint.empty()) {
    throw MalformedRow(fmt::format("names a column {}{}", in_quotes(name), hint));
  }
  warn("column not used", in_quotes(name));
  return {name, Unused{}};
}

void CsvRows::read_header(std::string_view line, const RowWarn& warn) {
  if (line.find(',') == std::string_view::npos) throw MalformedRow("has no comma: separate columns by commas");
  std::vector<Column> columns;
  std::unordered_set<std::string> names;  // a set, because a header may name a hundred thousand
  std::string cell;
  for (std::string_view rest = line; next_cell(rest, cell);) {
    const std::string name = in_small_letters(cell);
    const bool is_new = name.empty() || names.insert(name).second;
    if (!is_new && !table_hint(name).empty()) {
      throw MalformedRow(fmt::format("names the column {} twice", in_quotes(name)));
    }
    columns.push_back(make_column(name, warn));
  }
  const auto has = [&columns](auto meaning) {
    return std::any_of(columns.begin(), columns.end(), [meaning](const Column& one) {
      const auto* const known = std::get_if<decltype(meaning)>(&one.meaning);
      return known != nullptr && *known == meaning;
    });
  };
  if (!has(TableNumber::kStamp)) throw MalformedRow("names no column stamp: the first line names the columns");
  if (coordinates_ % 2 != 0) throw MalformedRow("has a column of x without that of y behind it");
  columns_ = std::move(columns);
}

void CsvRows::take(const Column& column, const std::string& cell, TableRow& row) const {
  if (const auto* number = std::get_if<TableNumber>(&column.meaning)) {
    if (cell.empty()) return;
    if (*number == TableNumber::kTicks) {
      row.ticks = table_whole(cell, column.name);
    } else {
      row[*number] = table_value(cell, column.name);
    }
  } else if (const auto* list = std::get_if<TableList>(&column.meaning)) {
    if (cell.empty()) return;
    const bool is_ranges = *list == TableList::kRanges;
    (is_ranges ? row.has_ranges : row.has_points) = true;
    append_listed_numbers(cell, column.name, is_ranges ? row.ranges_m : row.points_m);
  } else if (const auto* text = std::get_if<TableText>(&column.meaning)) {
    if (*text == TableText::kValue) row.value = cell;
    if (*text == TableText::kName && !cell.empty()) row.name = cell;
  } else if (const auto* member = std::get_if<Member>(&column.meaning)) {
    std::vector<double>& values = *member == Member::kRange ? row.ranges_m : row.points_m;
    values.push_back(cell.empty() ? std::numeric_limits<double>::quiet_NaN() : table_value(cell, column.name));
    if (!cell.empty()) (*member == Member::kRange ? row.has_ranges : row.has_points) = true;
  }
}

bool CsvRows::parse(std::string_view line, TableRow& row, const RowWarn& warn) {
  if (wants_header()) {
    read_header(line, warn);
    return false;
  }
  std::string cell;
  std::size_t count = 0;
  for (std::string_view rest = line; next_cell(rest, cell); ++count) {
    if (count < columns_.size()) take(columns_[count], cell, row);
  }
  if (count != columns_.size()) {
    throw MalformedRow(fmt::format("has {} cells where the header names {} columns", count, columns_.size()));
  }
  // Empty cells at the end of r0, r1, ... and x0, y0, ... make a shorter scan.
  if (ranges_ > 0) {
    while (!row.ranges_m.empty() && std::isnan(row.ranges_m.back())) row.ranges_m.pop_back();
  }
  if (coordinates_ > 0) {
    while (!row.points_m.empty() && std::isnan(row.points_m.back())) row.points_m.pop_back();
  }
  return true;
}

}  // namespace gdtslam
