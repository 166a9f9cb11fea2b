// Words and numbers on their way into the JSON of a page (into its HTML: drawing/markup.hpp). Names come from logs and
// files of others, so none is trusted. Thread-safe; O(length).
#pragma once

#include <string>
#include <string_view>

namespace gdtslam::page {

/// A JSON string with its quotes, of text made valid by clean_utf8; safe within a script element, as it holds no <, >
/// or &.
std::string json_text(std::string_view text);
/// The shortest decimal that reads back as the same double; null where it is not finite.
std::string json_number(double value);

/// Builds one JSON text. Keys are ours and need no escaping.
class JsonWriter {
 public:
  JsonWriter& open(std::string_view key, char bracket);  ///< "" as key within arrays and at the top
  JsonWriter& close();
  JsonWriter& text(std::string_view key, std::string_view value);
  JsonWriter& number(std::string_view key, double value);
  [[nodiscard]] const std::string& str() const { return out_; }

 private:
  void begin(std::string_view key);
  std::string out_;
  std::string closers_;
  bool needs_comma_ = false;
};

}  // namespace gdtslam::page
