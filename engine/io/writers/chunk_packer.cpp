#include "chunk_packer.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include <array>
#include <cstddef>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

[[noreturn]] void refuse_packing(ChunkPacking packing) {
  throw Error(ExitCode::kFailed, std::string(packing_name(packing)) + " cannot pack a chunk (out of memory)");
}

std::string lz4_packed(const std::string& bytes) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string packed(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  const std::size_t size = LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences);
  if (LZ4F_isError(size) != 0U) refuse_packing(ChunkPacking::kLz4);
  packed.resize(size);
  return packed;
}

std::string zstd_packed(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size) != 0U) refuse_packing(ChunkPacking::kZstd);
  packed.resize(size);
  return packed;
}

}  // namespace

std::string_view packing_name(ChunkPacking packing) {
  constexpr std::array<std::string_view, 3> kPackingNames{"none", "lz4", "zstd"};
  return kPackingNames[static_cast<std::size_t>(packing)];
}

std::string packed_chunk(const std::string& bytes, ChunkPacking packing) {
  if (packing == ChunkPacking::kLz4) return lz4_packed(bytes);
  return packing == ChunkPacking::kZstd ? zstd_packed(bytes) : bytes;
}

}  // namespace gdtslam
