#include "device_failure.hpp"

#include <string>

#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {

MapperOptions on_failure_of(const DeviceOptions& options) {
  MapperOptions failure{.fall_back = !options.no_fallback,
                        .cpu = {.threads = options.threads, .isa = {}},
                        .warn = [](const std::string& text) { print_remark("warning: " + text); }};
  if (!options.isa.empty()) failure.cpu.isa = isa_from_name(options.isa);
  return failure;
}

}  // namespace gdtslam
