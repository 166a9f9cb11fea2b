// Scans that wait for the end of a drive, beyond some memory in a file (ByteShelf). Not thread-safe. 20 bytes a point
// on a surface, 8 another, 16 a scan.
#pragma once

#include "engine/core/memory/byte_shelf.hpp"
#include "engine/mapping/surface/surface_points.hpp"

namespace gdtslam {

class ScanShelf {
 public:
  explicit ScanShelf(std::string folder, std::size_t memory_bytes = ByteShelf::kMemoryBytes)
      : shelf_(std::move(folder), memory_bytes) {}

  void put(const KeptScan& scan);
  [[nodiscard]] const ByteShelf& bytes() const { return shelf_; }

  /// Scans in the order in which they were put, those that are put meanwhile too.
  class Reader {
   public:
    explicit Reader(const ScanShelf& shelf) : reader_(shelf.shelf_) {}
    /// To be called once a scan at most. Throws FileError where the file cannot be read.
    KeptScan next();

   private:
    ByteShelf::Reader reader_;
  };

 private:
  ByteShelf shelf_;
};

}  // namespace gdtslam
