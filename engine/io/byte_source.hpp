// Bytes from a file, from memory or out of a gzip stream, in order and once. One source belongs to one thread.
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
  /// Bytes that came from the file so far, before they were unpacked.
  [[nodiscard]] virtual std::uint64_t bytes_from_file() const = 0;
  /// The defect at the end of the input (a gzip stream that stops early), else empty; known once read() gave 0.
  [[nodiscard]] virtual std::string defect() const { return {}; }
};

/// A descriptor of a file to read, or below 0 with errno. A named pipe waits until its writer gives something or goes;
/// Error(kInterrupted) where the process or this thread is asked to end meanwhile (interruption.hpp): 0.2 s at most.
int open_to_read(const std::string& path);
/// A file, "-" being standard input; FileError when it cannot be opened, also when it is a folder. Of a pipe, a
/// terminal or another device the end is also where the process or this thread is asked to end, seen within 0.2 s.
std::unique_ptr<ByteSource> open_file_source(const std::string& path);
std::unique_ptr<ByteSource> open_memory_source(std::span<const std::byte> data);
/// The first `most` bytes, fewer only at the end.
std::string read_head(ByteSource& source, std::size_t most);
/// The bytes that were read of a source to know what it is, then the rest of it.
std::unique_ptr<ByteSource> with_head(std::string head, std::unique_ptr<ByteSource> rest);
/// Unpacks gzip when the first two bytes say so, passes anything else through. `name` stands in messages.
std::unique_ptr<ByteSource> gunzip_if_packed(std::unique_ptr<ByteSource> packed, const std::string& name);

/// The whole input, at most `limit` bytes; InputError when it is longer, ending with `advice`, or out of proportion to
/// the packed file.
std::string read_all(ByteSource& source, std::size_t limit, const std::string& name, const std::string& advice = "");

}  // namespace gdtslam
