#include "device_option.hpp"

#include <vector>

#include "did_you_mean.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr unsigned kMostThreads = 1024;

// vulkan or vulkan:N
bool names_vulkan(const std::string& device) {
  constexpr std::string_view kVulkan = "vulkan";
  if (!device.starts_with(kVulkan)) return false;
  const std::string_view rest = std::string_view(device).substr(kVulkan.size());
  if (rest.empty()) return true;
  return rest.size() > 1 && rest.size() < 5 && rest.front() == ':' &&
         rest.substr(1).find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

void add_device_options(CLI::App& command, DeviceOptions& options) {
  command.add_option("--device", options.device, "Where to compute: auto, cpu, vulkan or vulkan:N")
      ->type_name("NAME")
      ->capture_default_str();
  command
      .add_option("--threads", options.threads, "Threads of the CPU; 0: one per processor. Results do not depend on it")
      ->type_name("N")
      ->check(CLI::Range(0U, kMostThreads).description(""))
      ->capture_default_str();
  command
      .add_option("--isa", options.isa,
                  "Force the CPU's instruction set: baseline, avx2 or avx512. Results do not depend on it")
      ->type_name("NAME");
  command.add_flag("--no-fallback", options.no_fallback,
                   "Fail (exit 69) rather than go on with the CPU when the device fails");
}

Isa isa_from_name(const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < kIsaCount; ++k) {
    names.emplace_back(name_of(static_cast<Isa>(k)));
    if (name == names.back()) return static_cast<Isa>(k);
  }
  throw UsageError("--isa: there is no instruction set '" + name + "'" + did_you_mean(name, names) +
                   " (baseline, avx2 or avx512)");
}

std::unique_ptr<Backend> make_backend(const DeviceOptions& options) {
  CpuOptions cpu{.threads = options.threads, .isa = {}};
  if (!options.isa.empty()) cpu.isa = isa_from_name(options.isa);
  if (names_vulkan(options.device)) {
    throw UnavailableError("--device " + options.device +
                           ": this build has no Vulkan backend; use --device cpu, which gives the same results");
  }
  if (options.device != "auto" && options.device != "cpu") {
    const std::vector<std::string> names{"auto", "cpu", "vulkan"};
    throw UsageError("--device: there is no device '" + options.device + "'" + did_you_mean(options.device, names) +
                     " (auto, cpu, vulkan or vulkan:N)");
  }
  return make_cpu_backend(cpu);
}

}  // namespace gdtslam
