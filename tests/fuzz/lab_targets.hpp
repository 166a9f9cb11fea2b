#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "target.hpp"
#include "tools/lab/reproduce/store.hpp"

namespace gdtslam::fuzz {

/// A part of a report that counts as finished: its texts are lines, its pictures lie beside it, and what is kept of it
/// is found again.
inline void read_kept_part(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  static const reproduce::Store store(folder.path());
  static const std::string place = store.folder_of("fig3");
  static const bool is_ready = [] {
    std::filesystem::create_directories(place);
    folder.put(reproduce::Store::place_of("fig3") + "/cells.svg", "<svg/>");
    return true;
  }();
  require(is_ready);
  folder.put(reproduce::Store::place_of("fig3") + "/part.json", text_of(data));
  const std::optional<reproduce::KeptPart> kept = store.find("fig3", "key");
  if (!kept) return;
  require(kept->cpu_s >= 0.0 && std::isfinite(kept->cpu_s) && is_one_line(kept->date.c_str()));
  for (const reproduce::Picture& picture : kept->part.pictures) {
    require(picture.file == "cells.svg" && is_one_line(picture.caption.c_str()));
  }
  for (const reproduce::Row& row : kept->part.rows) {
    require(is_one_line(row.ours.c_str()) && row.verdict <= reproduce::Verdict::kOpen);
  }
  require(kept->part.origin <= reproduce::Origin::kSimulatedAndReal);
}

inline constexpr std::array kLabTargets{FuzzTarget{"part", read_kept_part, 3}};

}  // namespace gdtslam::fuzz
