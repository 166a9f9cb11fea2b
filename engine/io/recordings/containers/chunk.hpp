// Chunks of a recording, unpacked as they are read. One source belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "counted_bytes.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/unpack_source.hpp"

namespace gdtslam {

/// The bytes of a file up to an end within it. Reading throws RecordingCut where the file ends before.
class ChunkBytes final : public ByteSource {
 public:
  ChunkBytes(CountedBytes& file, std::uint64_t end) : file_(file), end_(end) {}
  std::size_t read(std::span<char> target) override;
  [[nodiscard]] double progress() const override { return file_.source().progress(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return file_.source().bytes_from_file(); }

 private:
  CountedBytes& file_;
  std::uint64_t end_;
};

/// A message that was packed by itself (rosbag2's compression by message), out of `buffer`; others as they are, because
/// no message of CDR begins like one of zstd. Throws RecordingFault for one that is damaged or longer than allowed.
std::string_view unpacked_message(std::string_view bytes, std::string& buffer);

/// `compression` as a chunk's header has it: none or nothing, bz2, lz4 (frames) or zstd. Throws RecordingFault for
/// another one, with `supported` of the container; reading throws RecordingFault where the data are damaged or stop
/// early. Memory: up to 128 MiB, the largest window of zstd that is accepted, as far as it is filled.
std::unique_ptr<ByteSource> unpacked_chunk(std::unique_ptr<ByteSource> packed, std::string_view compression,
                                           std::string_view supported);

}  // namespace gdtslam
