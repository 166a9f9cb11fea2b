#include "console.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "engine/drawing/letters.hpp"
#include "gdtslam/core/error.hpp"
#include "interrupt.hpp"

namespace gdtslam {
namespace {

// C0, DEL, C1 and the two separators, at which some programs begin a new line.
bool is_control(char32_t code) {
  return code < 0x20U || (code >= 0x7FU && code < 0xA0U) || code == 0x2028U || code == 0x2029U;
}

void print_line(const char* begin, std::string_view text) {
  std::fputs(fmt::format("{}{}\n", begin, printable(text)).c_str(), stderr);  // a terminal that is gone takes no more
  std::fflush(stderr);
}

}  // namespace

std::string printable(std::string_view text, std::string_view kept) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Letter letter = next_letter(text, at);
    const bool is_broken = letter.code == kUnknownLetter && letter.bytes != kUnknownLetterBytes;
    if (kept.find(letter.bytes) != std::string_view::npos || !(is_control(letter.code) || is_broken)) {
      shown += letter.bytes;
    } else if (letter.bytes == "\n") {
      shown += "\\n";
    } else {
      for (const char byte : letter.bytes) shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
    }
  }
  return shown;
}

void print_result(std::string_view text) {
  const std::string shown = printable(text, "\n\t");
  errno = 0;
  if (std::fwrite(shown.data(), 1, shown.size(), stdout) != shown.size() || std::fflush(stdout) != 0) {
    // The reader had enough, as `head` has, or its terminal is gone.
    if (errno == EPIPE || (errno == EIO && interrupted())) return;
    throw FileError("standard output", "cannot be written: " + std::generic_category().message(errno));
  }
}

void print_remark(std::string_view text) { print_line("gdtslam: ", text); }

void print_error(std::string_view text) { print_line("gdtslam: error: ", text); }

}  // namespace gdtslam
