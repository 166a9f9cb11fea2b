// Clouds as PLY [Turk1994] and PCD, written in binary and read in binary or ASCII, piece by piece. Memory does not
// depend on the number of points, except for reading PCD's binary_compressed, which is in memory as a whole. Every file
// is written to a temporary name, synced and renamed. Columns: x y z (float, metres), elevation (float, radians), time
// (double, seconds), scan (uint). A reader needs only x y z, accepts columns in any order and numeric type, and skips
// unknown columns. Cost: one pass. One object belongs to one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "gdtslam/core/cloud.hpp"

namespace gdtslam {

enum class CloudFormat : std::uint8_t { kPlyBinary, kPcdBinary };

/// By the name's extension, .ply or .pcd in small or capital letters. Throws UsageError for any other.
CloudFormat find_cloud_format(const std::string& path);

/// A cloud file that is being written.
class CloudWriter : public CloudSink {
 public:
  /// Throws FileError, as add() and finish() do, also for a pipe or terminal: the count in the header is written last.
  /// Without finish() no file remains.
  CloudWriter(const std::string& path, CloudFormat format);
  ~CloudWriter() override;
  void add(std::span<const CloudPoint> points) override;
  /// Writes the count into the header, syncs, renames.
  void finish();
  [[nodiscard]] std::uint64_t points() const;
  /// SHA-256 of the points in binary PLY, for any format; known after finish().
  [[nodiscard]] std::string points_sha256() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The statements of a cloud's header. None of them is trusted for an allocation.
struct CloudHeader {
  std::uint64_t points = 0;
  bool has_elevation = false;
  bool has_time = false;
  bool has_scan = false;
};

/// A cloud file that is read piece by piece.
class CloudReader {
 public:
  /// Opens a PLY or PCD file, plain or in gzip; the first line decides which. Throws InputError (file, line or point,
  /// and the fault) or FileError, as next() does.
  explicit CloudReader(const std::string& path);
  /// Reads bytes in memory, which must outlive the reader; `name` is for messages.
  CloudReader(std::span<const std::byte> data, const std::string& name);
  ~CloudReader();
  [[nodiscard]] const CloudHeader& header() const;
  /// Call it before the first next(). If the first point lies beyond 10 km on an axis, as in a national grid, whole
  /// kilometres are subtracted on that axis in double precision, because single-precision points would be off by
  /// decimetres. origin_m() returns the offset.
  void make_relative();
  [[nodiscard]] const std::array<double, 3>& origin_m() const;
  /// The next up to `most` points; empty at the end. Points with a value that is not finite are skipped and counted.
  Cloud next(std::size_t most = 65536);
  [[nodiscard]] std::uint64_t skipped() const;
  /// For a caller that keeps all points: throws InputError if their number is out of proportion to the packed file
  /// (io/file_limits.hpp).
  void check_kept(std::uint64_t points) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The whole cloud; *skipped (may be null) gets the number of points that are not finite. With `origin_m` the cloud is
/// relative (CloudReader::make_relative). Throws InputError, with advice, if there are more than max_points.
Cloud read_cloud(const std::string& path, std::uint64_t max_points = 200'000'000, std::uint64_t* skipped = nullptr,
                 std::array<double, 3>* origin_m = nullptr);

}  // namespace gdtslam
