// What every fuzz target is made of: bytes go to a reader, and a typed error of one line is a right answer; a crash, a
// leak, a hang, a broken promise or any other exception is not.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

#include "gdtslam/core/error.hpp"

namespace gdtslam::fuzz {

struct FuzzTarget {
  std::string_view name;  ///< and that of its folder in corpus/
  void (*read)(std::span<const std::byte> data);
  std::size_t fewest = 0;  ///< inputs that its corpus has at least
};

/// A broken promise of a reader; ends the program so that the fuzzer sees it.
inline void require(bool holds, const char* what = "a promise of the reader is broken") {
  if (holds) return;
  static_cast<void>(std::fprintf(stderr, "%s\n", what));
  std::abort();
}

inline bool is_one_line(const char* message) { return std::string_view(message).find('\n') == std::string_view::npos; }

/// Nothing else than one of these errors may come out, and what it says is one line.
template <class... Expected, class Read>
void expect_typed(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    require((... || (dynamic_cast<const Expected*>(&error) != nullptr)), error.what());
    require(is_one_line(error.what()), error.what());
  }
}

inline std::string_view text_of(std::span<const std::byte> data) {
  return {reinterpret_cast<const char*>(data.data()), data.size()};
}
inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

/// For readers that want files. A process has one for each target that needs it, and it goes with the process.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "gdtslam-fuzz-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string file(std::string_view name) const { return path_ + "/" + std::string(name); }
  /// The file's path.
  std::string put(std::string_view name, std::string_view bytes) const {
    std::string path = file(name);
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    const bool is_written =
        descriptor >= 0 && ::write(descriptor, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
    if (descriptor >= 0) ::close(descriptor);
    if (!is_written) throw std::runtime_error("cannot write " + path);
    return path;
  }
  void remove(std::string_view name) const {
    std::error_code ignored;
    std::filesystem::remove(file(name), ignored);
  }

 private:
  std::string path_;
};

/// An input of several files: the first one, then after each line "=== NAME" that of this name, a newline before the
/// next such line left out.
inline std::map<std::string, std::string, std::less<>> files_in(std::string_view input, std::string first) {
  constexpr std::string_view kMark = "=== ";
  std::map<std::string, std::string, std::less<>> files;
  std::string name = std::move(first);
  while (true) {
    const std::size_t mark = input.starts_with(kMark) ? 0 : input.find("\n=== ");
    const std::size_t end = std::min(mark, input.size());
    files[name] = std::string(input.substr(0, end));
    if (mark == std::string_view::npos) return files;
    input.remove_prefix(end + kMark.size() + (input[end] == '\n' ? 1 : 0));
    const std::size_t newline = std::min(input.find('\n'), input.size());
    name = std::string(input.substr(0, newline));
    input.remove_prefix(std::min(newline + 1, input.size()));
  }
}

/// Those of the names in a folder, and no others of them.
template <std::size_t count>
void put_files(const ScratchFolder& folder, const std::map<std::string, std::string, std::less<>>& files,
               const std::array<std::string_view, count>& names) {
  for (const std::string_view name : names) {
    const auto found = files.find(name);
    if (found == files.end()) {
      folder.remove(name);
    } else {
      folder.put(name, found->second);
    }
  }
}

}  // namespace gdtslam::fuzz
