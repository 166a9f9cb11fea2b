// Linkages, and maps as `localize` reads them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/folder/linkage_file.hpp"
#include "engine/runs/localizer/map_field.hpp"
#include "gdtslam/io/map_files.hpp"
#include "target.hpp"

namespace gdtslam::fuzz {

inline void read_linkage_description(std::span<const std::byte> data) {
  expect_typed<ConfigError>([&] {
    const LinkageFile linkage = read_linkage_text(std::string(text_of(data)), "fuzz");
    require(calib::validate(linkage.model).empty());
    const std::string written = linkage_text(linkage.model, linkage.uncertainty);
    const LinkageFile again = read_linkage_text(written, "written");
    require(linkage_text(again.model, again.uncertainty) == written);
    require(again.uncertainty == linkage.uncertainty);
    const ElevationTable table = elevation_table(linkage.model, 6);
    for (const double elevation_rad : table.values_rad()) require(std::isfinite(elevation_rad));
  });
}

/// A map as `localize` takes it, of this or another program: what it makes of it, beside an image or a field.
inline void read_localizer_map(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  static const bool is_ready = [] {
    folder.put("map.pgm", std::string_view("P5\n3 2\n255\n\x00\xfe\xcd\xfe\xfe\x00", 17));
    const std::vector<std::uint16_t> cells{0, 256, 5120};
    write_distance_field(folder.file("gdt.yaml"), rows_of(DistanceFieldView{{0.05, 1.0, 2.0, 3, 1}, 3, cells, 5120}));
    return true;
  }();
  require(is_ready);
  expect_typed<InputError, FileError>([&] {
    const MapField field = read_map_field(folder.put("map.yaml", text_of(data)), MapConfig());
    const FieldView view = field.view();
    require(view.width > 0 && view.height > 0 && view.stride >= view.width && field.kernel_origin_m.allFinite());
    const PoseWindow window = field.known_window();
    require(window.centre.is_finite() && window.half_x_m > 0.0 && window.half_y_m > 0.0);
  });
}

inline constexpr std::array kRunTargets{FuzzTarget{"linkage", read_linkage_description, 12},
                                        FuzzTarget{"localizer_map", read_localizer_map, 4}};

}  // namespace gdtslam::fuzz
