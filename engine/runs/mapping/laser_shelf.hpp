// Scans as the laser gave them that wait until it is known where they belong, beyond some memory in a file (ByteShelf).
// Not thread-safe. 4 bytes a range and 120 a scan.
#pragma once

#include "engine/core/memory/byte_shelf.hpp"
#include "gdtslam/core/stream.hpp"

namespace gdtslam {

class LaserShelf {
 public:
  explicit LaserShelf(std::string folder, std::size_t memory_bytes = ByteShelf::kMemoryBytes)
      : shelf_(std::move(folder), memory_bytes) {}

  void put(const LaserScan& scan);
  [[nodiscard]] const ByteShelf& bytes() const { return shelf_; }

  /// Scans in the order in which they were put, those that are put meanwhile too.
  class Reader {
   public:
    explicit Reader(const LaserShelf& shelf) : reader_(shelf.shelf_) {}
    /// To be called once a scan at most. Throws FileError where the file cannot be read.
    LaserScan next();

   private:
    ByteShelf::Reader reader_;
  };

 private:
  ByteShelf shelf_;
};

}  // namespace gdtslam
