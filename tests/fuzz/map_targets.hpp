// Maps, pictures, clouds, meshes, trajectories and the configuration.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/maps/png.hpp"
#include "engine/io/meshes/mesh_file.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "gdtslam/io/map_files.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/config.hpp"
#include "target.hpp"

namespace gdtslam::fuzz {

inline void read_configuration(std::span<const std::byte> data) {
  MapperConfig config;
  const std::vector<Option> options = option_table(config);
  expect_typed<ConfigError>([&] {
    read_config_text(text_of(data), "fuzz", options);
    require(violations(options).empty());
    MapperConfig again;
    const std::vector<Option> options_again = option_table(again);
    const std::string written = config_text(options);
    read_config_text(written, "written", options_again);
    require(config_text(options_again) == written);
  });
}

inline void read_map_image(std::span<const std::byte> data) {
  expect_typed<InputError>([&] {
    const Grey8Image image = decode_pgm(data, "fuzz");
    require(image.pixels.size() == std::size_t{image.width} * image.height && image.pixels.size() < data.size());
  });
}

/// The description of a map; beside it lie an image, a folder with one, and a link that leads out.
inline void read_map_description(std::span<const std::byte> data) {
  static const ScratchFolder outside;
  static const ScratchFolder folder;
  static const bool is_ready = [] {
    const std::string image("P5\n3 2\n255\n\x00\xfe\xcd\xfe\xfe\x00", 17);
    folder.put("map.pgm", image);
    std::filesystem::create_directory(folder.file("sub"));
    folder.put("sub/map.pgm", image);
    std::filesystem::create_symlink(outside.put("map.pgm", image), folder.file("out.pgm"));
    return true;
  }();
  require(is_ready);
  expect_typed<InputError, FileError>([&] {
    const OccupancyMap map = read_occupancy_map(folder.put("map.yaml", text_of(data)));
    const GridGeometry& grid = map.geometry;
    require(grid.width == 3 && grid.height == 2 && grid.resolution_m > 0.0 && std::isfinite(grid.resolution_m) &&
            std::isfinite(grid.origin_x_m) && std::isfinite(grid.origin_y_m));
    write_occupancy_map(folder.file("again.yaml"), map);
    const OccupancyMap again = read_occupancy_map(folder.file("again.yaml"));
    require(again.geometry == grid, "a map that is written again lies elsewhere");
    for (std::size_t cell = 0; cell < 6; ++cell) require(again.cells[cell] == map.cells[cell]);
  });
}

inline void read_trajectory(std::span<const std::byte> data) {
  expect_typed<InputError>([&] {
    for (const StampedPose& pose : read_tum(data, "fuzz")) require(pose.T_map_base.is_finite());
  });
}

inline void read_relation_file(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  expect_typed<InputError>([&] {
    for (const Relation& relation : read_relations(folder.put("relations", text_of(data)))) {
      require(relation.T_1_2.is_finite() && std::isfinite(relation.t1_s) && std::isfinite(relation.t2_s));
    }
  });
}

namespace detail {

inline std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes.substr(0, 4)) value = value << 8U | static_cast<std::uint8_t>(byte);
  return value;
}
inline std::string big_endian_bytes(std::uint32_t value) {
  std::string bytes;
  for (unsigned shift = 32; shift > 0;) bytes += static_cast<char>(value >> (shift -= 8) & 0xffU);
  return bytes;
}

/// The same chunks with lengths and checksums that hold; rows that are not packed are packed.
inline std::string with_png_checksums(std::string_view png) {
  constexpr std::size_t kSignature = 8;
  constexpr std::size_t kAround = 12;  // length, kind and checksum
  constexpr char kZlib = '\x78';
  if (png.size() < kSignature) return std::string(png);
  std::string mended = "\x89PNG\r\n\x1a\n";
  for (png.remove_prefix(kSignature); png.size() >= kAround;) {
    const std::size_t length = std::min<std::size_t>(big_endian(png), png.size() - kAround);
    const std::string kind(png.substr(4, 4));
    std::string content(png.substr(8, length));
    png.remove_prefix(length + kAround);
    if (kind == "IDAT" && !content.starts_with(kZlib)) {
      std::string packed(compressBound(static_cast<uLong>(content.size())), '\0');
      auto size = static_cast<uLongf>(packed.size());
      require(compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(content.data()),
                        static_cast<uLong>(content.size()), Z_BEST_SPEED) == Z_OK);
      content = packed.substr(0, size);
    }
    const std::string summed = kind + content;
    const auto crc = static_cast<std::uint32_t>(
        ::crc32(0, reinterpret_cast<const Bytef*>(summed.data()), static_cast<uInt>(summed.size())));
    mended += big_endian_bytes(static_cast<std::uint32_t>(content.size())) + summed + big_endian_bytes(crc);
  }
  return mended;
}

inline void read_png(std::span<const std::byte> data) {
  constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 22U;
  expect_typed<InputError>([&] {
    const Grey16Image image = decode_png_grey16(data, "fuzz", kMaxPixels);
    require(image.pixels.size() == std::size_t{image.width} * image.height && image.pixels.size() <= kMaxPixels);
  });
  expect_typed<InputError>([&] {
    const Grey8Image image = decode_png_grey8(data, "fuzz", kMaxPixels);
    require(image.pixels.size() == std::size_t{image.width} * image.height && image.pixels.size() <= kMaxPixels);
  });
}

}  // namespace detail

inline void read_distance_image(std::span<const std::byte> data) {
  detail::read_png(data);
  detail::read_png(bytes_of(detail::with_png_checksums(text_of(data))));
}

/// PLY and PCD: which it is stands in the first line.
inline void read_cloud_file(std::span<const std::byte> data) {
  expect_typed<InputError>([&] {
    CloudReader reader(data, "fuzz");
    std::uint64_t points = 0;
    for (Cloud piece = reader.next(100); !piece.empty(); piece = reader.next(100)) {
      require(piece.size() <= 100);
      for (const CloudPoint& p : piece) {
        require(std::isfinite(p.x_m) && std::isfinite(p.y_m) && std::isfinite(p.z_m) &&
                std::isfinite(p.elevation_rad) && std::isfinite(p.stamp_s));
      }
      points += piece.size();
    }
    require(points + reader.skipped() == reader.header().points);
  });
}

/// The same bytes in both formats of meshes, because the name tells which it is.
inline void read_mesh_file(std::span<const std::byte> data) {
  for (const char* name : {"fuzz.stl", "fuzz.ply"}) {
    expect_typed<InputError>([&] {
      const MeshFile mesh = read_mesh(data, name, {.max_triangles = 10'000});
      require(!mesh.triangles.empty() && mesh.triangles.size() <= 10'000 && mesh.vertices.size() <= 30'000);
      for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
        for (const std::uint32_t corner : triangle) require(corner < mesh.vertices.size());
      }
      for (const std::array<float, 3>& v : mesh.vertices) {
        require(std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]));
      }
    });
  }
}

inline constexpr std::array kMapTargets{
    FuzzTarget{"config", read_configuration, 8},     FuzzTarget{"map", read_map_image, 3},
    FuzzTarget{"map_yaml", read_map_description, 5}, FuzzTarget{"tum", read_trajectory, 2},
    FuzzTarget{"relations", read_relation_file, 3},  FuzzTarget{"png", read_distance_image, 2},
    FuzzTarget{"cloud", read_cloud_file, 10},        FuzzTarget{"mesh", read_mesh_file, 8},
};

}  // namespace gdtslam::fuzz
