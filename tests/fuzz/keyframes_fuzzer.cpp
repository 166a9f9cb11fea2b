// libFuzzer's entry for keyframes.
#include <cstddef>
#include <cstdint>
#include <span>

#include "keyframes_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gdtslam::fuzz::read_keyframes(std::as_bytes(std::span(data, size)));
  return 0;
}
