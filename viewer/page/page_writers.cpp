#include "page_writers.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>

#include "engine/core/base64.hpp"
#include "engine/drawing/markup.hpp"

namespace gdtslam::page {
namespace {

std::string unicode_escape(std::uint32_t code) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string out = "\\u";
  for (int shift = 12; shift >= 0; shift -= 4) {
    out += kDigits[code >> static_cast<unsigned>(shift) & 0xFU];
  }
  return out;
}

}  // namespace

std::string json_text(std::string_view text) {
  constexpr std::string_view kEscaped = "\"\\<>&";
  std::string out = "\"";
  for (const char c : clean_utf8(text)) {
    const std::uint32_t byte = static_cast<unsigned char>(c);
    if (byte < 0x20U || kEscaped.find(c) != std::string_view::npos) {
      out += unicode_escape(byte);
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string json_number(double value) {
  if (!std::isfinite(value)) return "null";
  char digits[32];
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof digits, value);
  return {digits, end.ptr};
}

void JsonWriter::begin(std::string_view key) {
  if (needs_comma_) out_ += ',';
  needs_comma_ = true;
  if (!key.empty()) out_.append("\"").append(key).append("\":");
}

JsonWriter& JsonWriter::open(std::string_view key, char bracket) {
  begin(key);
  out_ += bracket;
  closers_ += bracket == '{' ? '}' : ']';
  needs_comma_ = false;
  return *this;
}

JsonWriter& JsonWriter::close() {
  out_ += closers_.back();
  closers_.pop_back();
  needs_comma_ = true;
  return *this;
}

JsonWriter& JsonWriter::text(std::string_view key, std::string_view value) {
  begin(key);
  out_ += json_text(value);
  return *this;
}

JsonWriter& JsonWriter::number(std::string_view key, double value) {
  begin(key);
  out_ += json_number(value);
  return *this;
}

JsonWriter& JsonWriter::point(std::string_view key, const Point3& value) {
  return open(key, '[').number("", value.x()).number("", value.y()).number("", value.z()).close();
}

void append_bytes_element(const std::string& id, std::span<const std::uint8_t> bytes, std::string& out) {
  out.append("<script type=\"text/plain\" id=\"").append(id).append("\">");
  append_base64(std::as_bytes(bytes), out);
  out.append("</script>\n");
}

}  // namespace gdtslam::page
