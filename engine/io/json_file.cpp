#include "json_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "atomic_file.hpp"
#include "byte_source.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr int kMostDepth = 16;  // our deepest file, report.json, has 4 levels
// report.json of a day of scans (288,000 at 10 Hz), all of them doubtful, has seven for each.
constexpr std::size_t kMostValues = 2'500'000;
// Ordered objects search all earlier members for each new one. Our largest, a report, has some forty; 2.5 million
// values in objects of 256 take a second.
constexpr std::size_t kMostMembers = 256;
constexpr std::size_t kMostQuotedBytes = 1U << 20U;  // our longest, a command line, has at most 128 KiB

// Counts the values that the parser would make, without making them, even in invalid JSON. Returns the exceeded limit,
// or an empty text.
std::string find_excess(std::string_view text) {
  int depth = 0;
  std::array<std::size_t, kMostDepth + 1>
      members{};  // number of members of the open object at each depth; lists have none
  std::size_t values = 1;
  bool is_quoted = false;
  std::size_t quote = 0;  // where the last one began
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (is_quoted) {
      if (k - quote > kMostQuotedBytes) return fmt::format("has a text of more than {} bytes", kMostQuotedBytes);
      k += c == '\\' ? 1U : 0U;
      is_quoted = c != '"';
      continue;
    }
    is_quoted = c == '"';
    quote = k;
    const bool opens = c == '[' || c == '{';
    depth += opens ? 1 : 0;
    depth -= c == ']' || c == '}' ? 1 : 0;
    values += opens || c == ',' ? 1U : 0U;
    if (opens && depth > 0 && depth <= kMostDepth) members.at(static_cast<std::size_t>(depth)) = 0;
    if (c == ':' && depth > 0 && ++members.at(static_cast<std::size_t>(depth)) > kMostMembers) {
      return fmt::format("has an object of more than the {} members that are read", kMostMembers);
    }
    if (depth > kMostDepth) return fmt::format("is nested deeper than the {} levels that are read", kMostDepth);
    if (values > kMostValues) return fmt::format("holds more than the {} values that are read", kMostValues);
  }
  return "";
}

using Json = nlohmann::ordered_json;

constexpr std::size_t kColumns = 120;

// [1, 2] or {"a": 1}, and plain values.
std::string on_one_line(const Json& value) {
  // In ASCII, because a terminal obeys some control characters.
  if (!value.is_structured()) return value.dump(-1, ' ', true, Json::error_handler_t::replace);
  std::string text = value.is_object() ? "{" : "[";
  for (auto entry = value.begin(); entry != value.end(); ++entry) {
    if (entry != value.begin()) text += ", ";
    if (value.is_object()) text += on_one_line(Json(entry.key())) + ": ";
    text += on_one_line(*entry);
  }
  return text + (value.is_object() ? '}' : ']');
}

bool is_plain(const Json& value) { return !value.is_structured(); }
bool is_text(const Json& value) { return value.is_string(); }
bool is_list_of_plain(const Json& value) {
  return value.is_array() && std::all_of(value.begin(), value.end(), is_plain);
}

// True for a list's entry that fits in one line.
bool is_row(const Json& value) {
  return is_list_of_plain(value) || (value.is_object() && std::all_of(value.begin(), value.end(), [](const Json& part) {
                                       return is_plain(part) || is_list_of_plain(part);
                                     }));
}

bool is_written_on_one_line(const Json& value, std::size_t column, bool is_entry) {
  if (is_plain(value) || value.empty()) return true;
  if (is_list_of_plain(value) && std::none_of(value.begin(), value.end(), is_text)) return true;
  const bool may_be = is_list_of_plain(value) || (is_entry && is_row(value));
  return may_be && column + on_one_line(value).size() < kColumns;
}

void write_value(const Json& value, std::size_t indent, std::size_t column, bool is_entry, std::string& text) {
  constexpr std::size_t kStep = 2;
  if (is_written_on_one_line(value, column, is_entry)) {
    text += on_one_line(value);
    return;
  }
  const bool is_object = value.is_object();
  text += is_object ? '{' : '[';
  for (auto entry = value.begin(); entry != value.end(); ++entry) {
    text += entry == value.begin() ? "\n" : ",\n";
    const std::string name = is_object ? on_one_line(Json(entry.key())) + ": " : "";
    text.append(indent + kStep, ' ') += name;
    write_value(*entry, indent + kStep, indent + kStep + name.size(), !is_object, text);
  }
  (text += '\n').append(indent, ' ') += is_object ? '}' : ']';
}

}  // namespace

std::string json_text(const nlohmann::ordered_json& value) {
  std::string text;
  write_value(value, 0, 0, false, text);
  return text + "\n";
}

void write_json(const std::string& path, const nlohmann::ordered_json& value) {
  write_file_atomically(path, json_text(value));
}

nlohmann::ordered_json parse_json(std::string_view text, const std::string& name, const std::string& advice) {
  const std::string excess = find_excess(text);
  if (!excess.empty()) throw InputError({name, 0}, excess + advice);
  try {
    return nlohmann::ordered_json::parse(text);
  } catch (const nlohmann::ordered_json::parse_error& error) {
    const auto* const end = text.data() + std::min(error.byte, text.size());
    const auto line = static_cast<std::uint64_t>(std::count(text.data(), end, '\n')) + 1;
    throw InputError({name, line}, "is no JSON text" + advice);
  } catch (const nlohmann::ordered_json::exception&) {
    throw InputError({name, 0}, "holds a number that no double can hold" + advice);
  }
}

nlohmann::ordered_json read_json(const std::string& path, std::size_t most_bytes, const std::string& advice) {
  const std::unique_ptr<ByteSource> source = open_file_source(path);
  return parse_json(read_all(*source, most_bytes, path, advice), path, advice);
}

}  // namespace gdtslam
