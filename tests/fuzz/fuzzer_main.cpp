// libFuzzer's entry; GDTSLAM_FUZZ_TARGET names the function of targets.hpp.
#include <cstddef>
#include <cstdint>
#include <span>

#include "targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gdtslam::fuzz::GDTSLAM_FUZZ_TARGET(std::as_bytes(std::span(data, size)));
  return 0;
}
