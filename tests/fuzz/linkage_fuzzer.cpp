// libFuzzer's entry for linkage files.
#include <cstddef>
#include <cstdint>
#include <span>

#include "linkage_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gdtslam::fuzz::read_linkage(std::as_bytes(std::span(data, size)));
  return 0;
}
