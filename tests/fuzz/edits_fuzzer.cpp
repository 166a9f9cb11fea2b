// libFuzzer's entry for edits.json.
#include <cstddef>
#include <cstdint>
#include <span>

#include "edits_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gdtslam::fuzz::read_edits_text(std::as_bytes(std::span(data, size)));
  return 0;
}
