#include "scan_shelf.hpp"

namespace gdtslam {
namespace {

struct PointCounts {
  std::uint32_t surface = 0;
  std::uint32_t lone = 0;
};

}  // namespace

void put_on(ByteShelf& shelf, const KeptScan& scan) {
  const PointCounts counts{static_cast<std::uint32_t>(scan.surface.size()),
                           static_cast<std::uint32_t>(scan.lone.size())};
  shelf.put({bytes_of(counts), std::as_bytes(std::span(scan.surface)), std::as_bytes(std::span(scan.lone))});
}

void take_from(std::span<const std::byte> record, KeptScan& scan) {
  PointCounts counts;
  take_values(record, std::span(&counts, 1));
  scan.surface.resize(counts.surface);
  scan.lone.resize(counts.lone);
  take_values(record, std::span(scan.surface));
  take_values(record, std::span(scan.lone));
}

}  // namespace gdtslam
