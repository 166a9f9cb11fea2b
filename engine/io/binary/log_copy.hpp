// Reads the copy of a log that a run keeps (docs/formats.md, "Log copies"): the records as the log's reader gave them,
// bit for bit, its warnings, and how far a copy goes that was cut. Memory is bounded by the largest frame allowed
// (64 MiB), whatever the copy's length. One reader belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "engine/io/byte_source.hpp"
#include "engine/io/log_contents.hpp"
#include "log_copy_records.hpp"

namespace gdtslam {

/// A copy out of a source that begins with its magic; `name` stands in messages. Reading throws InputError where the
/// copy is damaged; with ReadOptions::lenient it ends there with a warning, as it does where it was cut.
std::unique_ptr<DescribedLog> open_log_copy(std::unique_ptr<ByteSource> source, const std::string& name,
                                            const ReadOptions& options);
/// A copy in memory, which must outlive the reader.
std::unique_ptr<DescribedLog> open_log_copy(std::span<const std::byte> data, const std::string& name,
                                            const ReadOptions& options);

/// How far a copy goes.
struct LogCopyExtent {
  std::uint64_t records = 0;
  std::uint64_t whole_bytes = 0;  ///< of its head and the whole frames of records
  /// The same without a last frame that its end may have cut short: behind these frames the copy of the whole log goes
  /// on with the same bytes.
  std::uint64_t sure_records = 0;
  std::uint64_t sure_bytes = 0;
  std::optional<LogCopyEnd> end;  ///< nothing where it was cut
  [[nodiscard]] bool is_of_whole_log() const { return end && end->is_whole; }
};
/// Reads all frames without unpacking them; a damaged frame, which a power failure may leave, ends it, and of a file
/// that ends within its head no byte counts. Throws InputError where the file is no copy of a version that is known,
/// FileError.
LogCopyExtent extent_of_log_copy(const std::string& path);

}  // namespace gdtslam
