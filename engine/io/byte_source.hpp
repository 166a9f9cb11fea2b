// Bytes from a file, from memory or from a gzip stream, in order and once. One source belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace gdtslam {

class ByteSource {
 public:
  ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;
  virtual ~ByteSource() = default;
  /// Fills at most the target; 0 only at the end. Throws FileError or InputError.
  virtual std::size_t read(std::span<char> target) = 0;
  /// Share of the input consumed, 0 to 1; negative when unknown.
  [[nodiscard]] virtual double progress() const = 0;
  /// Bytes read from the file so far, before unpacking.
  [[nodiscard]] virtual std::uint64_t bytes_from_file() const = 0;
  /// The defect at the end of the input (a gzip stream that stops early), else empty; known once read() returned 0.
  [[nodiscard]] virtual std::string defect() const { return {}; }
};

/// Opens a file for reading: a descriptor, or below 0 with errno. For a named pipe it waits until its writer sends
/// bytes or closes it. Throws Error(kInterrupted) within 0.2 s if the process or this thread is asked to end meanwhile
/// (interruption.hpp).
int open_to_read(const std::string& path);
/// Opens a file, "-" being standard input; FileError if it cannot be opened or is a folder. A pipe, a terminal or
/// another device also ends within 0.2 s if the process or this thread is asked to end.
std::unique_ptr<ByteSource> open_file_source(const std::string& path);
std::unique_ptr<ByteSource> open_memory_source(std::span<const std::byte> data);
/// The first `most` bytes, fewer only at the end.
std::string read_head(ByteSource& source, std::size_t most);
/// The bytes read from a source to identify it, then the rest of it.
std::unique_ptr<ByteSource> with_head(std::string head, std::unique_ptr<ByteSource> rest);
/// Unpacks gzip, recognised by the first two bytes; passes anything else through. `name` is for messages.
std::unique_ptr<ByteSource> gunzip_if_packed(std::unique_ptr<ByteSource> packed, const std::string& name);

/// The whole input, at most `limit` bytes; InputError, ending with `advice`, if it is longer, or out of proportion to
/// the packed file.
std::string read_all(ByteSource& source, std::size_t limit, const std::string& name, const std::string& advice = "");

}  // namespace gdtslam
