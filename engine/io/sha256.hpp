// SHA-256 [FIPS2015] by OpenSSL's libcrypto, to compare results by one line. Not thread-safe; O(n).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "engine/io/byte_source.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/map_files.hpp"

struct evp_md_ctx_st;  // a type of OpenSSL

namespace gdtslam {

class Sha256 {
 public:
  Sha256();
  Sha256& update(std::span<const std::byte> data);
  Sha256& update(std::string_view text);
  /// Adds numbers as little-endian bytes on every host.
  Sha256& update(double value);
  Sha256& update(std::int32_t value);
  Sha256& update(std::uint16_t value);
  /// 64 hexadecimal digits; the object can be used no further.
  std::string hex();

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

struct HashedBytes {
  std::string sha256;
  std::uint64_t bytes = 0;
};
/// The hash of a whole source, in constant memory. Calls `before_piece` before each piece; if it throws, reading stops.
/// Throws FileError.
HashedBytes sha256_of(ByteSource& source, const std::function<void()>& before_piece = {});
HashedBytes sha256_of_file(const std::string& path, const std::function<void()>& before_piece = {});

/// The hash of the GDT: resolution, origin x and y (doubles), width and height (int32), then its cells row by row
/// (uint16), without the padding of the rows; all little-endian.
std::string sha256_of(const DistanceFieldRows& field);
/// The hash of the poses: x, y and theta of each (doubles, little-endian).
std::string sha256_of(const Trajectory& trajectory);

}  // namespace gdtslam
