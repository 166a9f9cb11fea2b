// Files that appear whole or not at all: written to a temporary name in the same folder, synced and renamed, then the
// folder is synced. On any failure (disk full, no permission, an exception) the old file stays unchanged and the
// temporary one is removed; a killed process leaves it. A link is followed and stays a link; a device or a pipe is
// written directly. One object belongs to one thread.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

/// The reader of a pipe has closed it, as `head` does once it has enough.
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
  /// Without commit() no file remains.
  ~AtomicFile();

  void write(std::string_view text);
  void write(std::span<const std::byte> data);
  /// Replaces the first bytes, which must have been written; FileError if the target is a pipe.
  void rewrite_begin(std::string_view text);
  /// Syncs the temporary file to the disk; commit() does it too.
  void sync();
  /// Renames the file to its name; the last call.
  void commit();
  [[nodiscard]] const std::string& path() const { return path_; }
  /// The path to write to before commit(), for a library that writes the bytes itself. Throws FileError for a pipe or a
  /// device.
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
  std::string temporary_;  ///< empty if the target is written directly
  int descriptor_ = -1;
  bool synced_ = false;
  std::vector<char> buffer_;
};

/// Several files that belong together. All are on the disk before the first is renamed, in the order in which they were
/// added. So add the file that refers to the others last.
class AtomicFileSet {
 public:
  AtomicFile& add(const std::string& path);
  void commit();

 private:
  std::vector<std::unique_ptr<AtomicFile>> files_;
};

/// Writes a whole file.
void write_file_atomically(const std::string& path, std::string_view text);

/// Copies the bytes and the permissions of a file. Throws FileError.
void copy_file_atomically(const std::string& from, const std::string& to);

/// Syncs the names in the folder to the disk, if its file system supports it. Throws FileError.
void sync_folder(const std::string& path);

/// Makes the folder and those above it; FileError if that fails or something else has its name.
void make_folder(const std::string& path);

}  // namespace gdtslam
