// A text file that appears whole or not at all, compressed if its name ends in .gz. The compressed stream has no name
// and no time, so the same text gives the same bytes. One object belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "engine/io/atomic_file.hpp"

namespace gdtslam {

class TextSink {
 public:
  /// `file` must outlive this; it is compressed when its path ends in .gz.
  explicit TextSink(AtomicFile& file);
  ~TextSink();
  TextSink(const TextSink&) = delete;
  TextSink& operator=(const TextSink&) = delete;

  /// Throws FileError, as finish() does.
  void write(std::string_view text);
  /// Ends the stream; the last call. The file still has to be committed.
  void finish();
  /// The length of the text, before compression.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  struct Deflater;
  AtomicFile& file_;
  std::unique_ptr<Deflater> deflater_;  ///< empty when the file is plain
  std::uint64_t bytes_ = 0;
};

}  // namespace gdtslam
