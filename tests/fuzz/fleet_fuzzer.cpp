// libFuzzer's entry for the files of an atlas.
#include <cstddef>
#include <cstdint>
#include <span>

#include "fleet_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gdtslam::fuzz::read_fleet_text(std::as_bytes(std::span(data, size)));
  return 0;
}
