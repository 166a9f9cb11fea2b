// Files that appear whole or not at all: written to a temporary name in the same folder, synced, renamed, the folder
// synced. Whatever fails (disk full, no permission, an exception on the way), the old file stays as it was, byte for
// byte, and the temporary one is removed; a process that is killed leaves it. A link is followed and stays a link; a
// device or a pipe is written directly. One object belongs to one thread.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

/// The reader of the pipe that is written has gone away, as `head` does once it has enough.
class NoReaderError : public FileError {
 public:
  using FileError::FileError;
};

class AtomicFile {
 public:
  /// Creates the temporary file. Throws FileError with the file and the system's text, as all members do.
  explicit AtomicFile(const std::string& path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  /// Without commit() nothing is left behind.
  ~AtomicFile();

  void write(std::string_view text);
  void write(std::span<const std::byte> data);
  /// Replaces the first bytes, which must have been written; FileError where the target is a pipe.
  void rewrite_begin(std::string_view text);
  /// Everything to the disk, still under the temporary name. commit() does it too.
  void sync();
  /// The file takes its name; the last call.
  void commit();
  [[nodiscard]] const std::string& path() const { return path_; }
  /// The path of the bytes until the file takes its name, for a library that writes them itself. Throws FileError for a
  /// pipe or a device.
  [[nodiscard]] const std::string& written_path() const;

 private:
  friend class AtomicFileSet;
  void take_name();
  void open_temporary();
  void flush();
  void write_through(const char* data, std::size_t size);
  [[noreturn]] void fail(const char* what, int code) const;

  std::string path_;       ///< the path that the caller gave, for messages
  std::string target_;     ///< links resolved
  std::string temporary_;  ///< empty when the target is written directly
  int descriptor_ = -1;
  bool synced_ = false;
  std::vector<char> buffer_;
};

/// Several files that belong together: all are on the disk before the first takes its name, and they take their names
/// in the order in which they were added, so that the one that refers to the others comes last.
class AtomicFileSet {
 public:
  AtomicFile& add(const std::string& path);
  void commit();

 private:
  std::vector<std::unique_ptr<AtomicFile>> files_;
};

/// A whole file at once.
void write_file_atomically(const std::string& path, std::string_view text);

/// The bytes and the permissions of a file, under another name. Throws FileError.
void copy_file_atomically(const std::string& from, const std::string& to);

/// The names in the folder to the disk, where its file system knows of such a thing. Throws FileError.
void sync_folder(const std::string& path);

/// Makes the folder and those above it; FileError when that fails or something else has its name.
void make_folder(const std::string& path);

}  // namespace gdtslam
