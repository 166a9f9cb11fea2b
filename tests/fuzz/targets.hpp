// What each fuzzer calls: a reader on bytes in memory. A typed error is a right answer; a crash, a leak, a hang or any
// other exception is not. tests/unit/io replays the corpus with the same functions under every compiler.
#pragma once

#include <cstddef>
#include <span>

namespace gdtslam::fuzz {

void read_carmen(std::span<const std::byte> data);
void read_config(std::span<const std::byte> data);
void read_map_image(std::span<const std::byte> data);
void read_trajectory(std::span<const std::byte> data);
void read_distance_image(std::span<const std::byte> data);

}  // namespace gdtslam::fuzz
