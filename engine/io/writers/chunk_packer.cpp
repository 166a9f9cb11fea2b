#include "chunk_packer.hpp"

#include <bzlib.h>
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

std::string bz2_packed(std::string bytes) {
  constexpr int kLargestBlock = 9;
  // What cannot be packed grows by at most 1 % and 600 bytes.
  std::string packed(bytes.size() + bytes.size() / 100 + 600, '\0');
  auto size = static_cast<unsigned>(packed.size());
  const int status = BZ2_bzBuffToBuffCompress(packed.data(), &size, bytes.data(), static_cast<unsigned>(bytes.size()),
                                              kLargestBlock, 0, 0);
  if (status != BZ_OK) refuse_packing(ChunkPacking::kBz2);
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
  constexpr std::array<std::string_view, 4> kPackingNames{"none", "lz4", "bz2", "zstd"};
  return kPackingNames[static_cast<std::size_t>(packing)];
}

std::string packed_chunk(const std::string& bytes, ChunkPacking packing) {
  if (packing == ChunkPacking::kLz4) return lz4_packed(bytes);
  if (packing == ChunkPacking::kBz2) return bz2_packed(bytes);
  return packing == ChunkPacking::kZstd ? zstd_packed(bytes) : bytes;
}

}  // namespace gdtslam
