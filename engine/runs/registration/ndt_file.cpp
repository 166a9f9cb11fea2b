#include "ndt_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "engine/io/atomic_file.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/referenced_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/keyframes/bytes.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kNdtMagic = "gdtslam-ndt-cube";
constexpr std::uint32_t kNdtVersion = 1;
constexpr std::size_t kNdtDigits = 64;  // of the checksum
constexpr std::size_t kLeastCubeBytes = 11;
constexpr std::size_t kMostNdtBytes = std::size_t{16} << 30U;
constexpr auto kHalfCube = static_cast<std::int64_t>(NdtMap::kStepsOfACube / 2.0);
constexpr std::array<bool, 6> kIsSquare{true, false, false, true, false, true};  // xx, xy, xz, yy, yz, zz

void append_signed(BytesOut& out, std::int64_t value) {
  out.varint(static_cast<std::uint64_t>(std::abs(value)) << 1U | (value < 0 ? 1U : 0U));
}

// A sum of `count` values of at most `most` each.
std::int64_t signed_from(BytesIn& in, std::int64_t count, std::int64_t most) {
  const std::uint64_t coded = in.varint();
  const auto size = static_cast<std::int64_t>(coded >> 1U);
  if (size > count * most) in.refuse("has a sum that its points cannot have");
  return (coded & 1U) != 0 ? -size : size;
}

void append_cube(BytesOut& out, const NdtSums& sums) {
  out.varint(static_cast<std::uint64_t>(sums.count));
  for (const std::int64_t sum : sums.sum) append_signed(out, sum);
  for (std::size_t k = 0; k < sums.products.size(); ++k) {
    if (kIsSquare.at(k)) {
      out.varint(static_cast<std::uint64_t>(sums.products.at(k)));
    } else {
      append_signed(out, sums.products.at(k));
    }
  }
}

NdtSums cube_from(BytesIn& in) {
  NdtSums sums;
  const std::uint64_t count = in.varint();
  if (count < 1 || count > static_cast<std::uint64_t>(NdtMap::kMostInACube)) {
    in.refuse(fmt::format("has a cube of {} points", count));
  }
  sums.count = static_cast<std::int64_t>(count);
  for (std::int64_t& sum : sums.sum) sum = signed_from(in, sums.count, kHalfCube);
  constexpr std::int64_t kMostProduct = kHalfCube * kHalfCube;
  for (std::size_t k = 0; k < sums.products.size(); ++k) {
    if (!kIsSquare.at(k)) {
      sums.products.at(k) = signed_from(in, sums.count, kMostProduct);
      continue;
    }
    const std::uint64_t square = in.varint();
    if (square > static_cast<std::uint64_t>(sums.count * kMostProduct)) {
      in.refuse("has a sum of squares that its points cannot have");
    }
    sums.products.at(k) = static_cast<std::int64_t>(square);
  }
  return sums;
}

void require_start(BytesIn& in) {
  if (in.text(kNdtMagic.size()) != kNdtMagic) in.refuse("holds no normal distributions of gdtslam");
  if (const std::uint32_t version = in.whole(); version != kNdtVersion) {
    in.refuse(fmt::format("has version {}, and this program reads version {}", version, kNdtVersion));
  }
}

}  // namespace

bool is_ndt_file(const std::string& path) { return extension_of(path) == ".ndt"; }

std::uint64_t write_ndt(const std::string& path, const NdtMap& map) {
  const auto cubes = map.cubes();
  BytesOut out;
  out.text(kNdtMagic).whole(kNdtVersion).number(map.cell_m()).whole(static_cast<std::uint32_t>(cubes.size()));
  std::uint64_t last = 0;
  for (const auto& [place, sums] : cubes) {
    out.varint(ndt_key(place) - last);
    last = ndt_key(place);
    append_cube(out, sums);
  }
  std::string bytes = out.take();
  bytes += Sha256().update(bytes).hex();
  write_file_atomically(path, bytes);
  return bytes.size();
}

NdtMap read_ndt(const std::string& path) {
  const std::string bytes = read_all(*open_file_source(path), kMostNdtBytes, path);
  BytesIn start(bytes, path);
  require_start(start);
  if (start.left() < kNdtDigits) start.refuse("ends within its header");
  const std::string_view body = std::string_view(bytes).substr(0, bytes.size() - kNdtDigits);
  if (bytes.compare(body.size(), kNdtDigits, Sha256().update(body).hex()) != 0) {
    throw InputError({path, 0}, "is damaged: its checksum is that of other bytes");
  }
  BytesIn in(body, path);
  require_start(in);
  const double cell_m = in.number("an edge");
  if (!NdtMap::is_edge(cell_m)) in.refuse(fmt::format("has cubes of {} m", cell_m));
  NdtMap map(cell_m);
  std::uint64_t key = 0;
  const std::uint32_t count = in.count("cubes", kLeastCubeBytes);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint64_t step = in.varint();
    if (step > ~key || (k > 0 && step == 0)) in.refuse("has cubes in another order than theirs");
    key += step;
    const NdtSums sums = cube_from(in);
    const NdtPlace place = ndt_place_of_key(key);
    if (!NdtMap::is_within_limit(place) || ndt_key(place) != key) in.refuse("has a cube beyond the limit");
    map.add(place, sums);
  }
  if (in.left() > 0) in.refuse(fmt::format("goes on for {} bytes after its last cube", in.left()));
  return map;
}

}  // namespace gdtslam
