#include "device_option.hpp"

#include <CLI/App.hpp>
#include <vector>

#include "cache_folder.hpp"
#include "device_choice.hpp"
#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "verify_record.hpp"

namespace gdtslam {
namespace {

constexpr unsigned kMostThreads = 1024;

bool found_wrong(const VulkanDeviceInfo& device) {
  const std::optional<VerifyRecord> record = user_records().find(device);
  return record && !record->passed();
}

}  // namespace

void add_device_options(CLI::App& command, DeviceOptions& options, bool with_fallback) {
  command
      .add_option("--device", options.device,
                  "Where to compute: auto (a GPU where there is one, else the CPU), cpu, vulkan or vulkan:N;\n"
                  "'gdtslam devices' lists them. Results do not depend on it")
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
  if (!with_fallback) return;
  command.add_flag("--no-fallback", options.no_fallback,
                   "Fail (exit 1, with the call of the driver) rather than go on with the CPU when the device fails");
}

Isa isa_from_name(const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < kIsaCount; ++k) {
    names.emplace_back(to_string(static_cast<Isa>(k)));
    if (name == names.back()) return static_cast<Isa>(k);
  }
  throw UsageError("--isa: there is no instruction set '" + name + "'" + did_you_mean(name, names) +
                   " (baseline, avx2 or avx512)");
}

std::unique_ptr<Backend> make_cpu(const DeviceOptions& options) {
  CpuOptions cpu{.threads = options.threads, .isa = {}};
  if (!options.isa.empty()) cpu.isa = isa_from_name(options.isa);
  return make_cpu_backend(cpu);
}

std::unique_ptr<VulkanBackend> make_vulkan(const DeviceOptions& options, VulkanOptions wanted) {
  const DeviceName name = parse_device_name(options.device);
  if (name.kind == DeviceName::Kind::kCpu) return nullptr;
  const DeviceChoice choice = choose_device(name, list_vulkan_devices(), found_wrong);
  if (!choice.remark.empty()) print_remark(choice.remark);
  if (!choice.index) return nullptr;
  wanted.index = choice.index;
  wanted.cache_folder = cache_folder().path;
  return make_vulkan_backend(wanted);
}

std::unique_ptr<Backend> make_backend(const DeviceOptions& options) {
  std::unique_ptr<Backend> cpu = make_cpu(options);  // a misspelt --isa is an error on any device
  try {
    if (std::unique_ptr<VulkanBackend> device = make_vulkan(options)) return device;
  } catch (const DeviceError& error) {
    if (options.no_fallback) throw;
    print_remark(std::string("warning: ") + error.what() + "; going on with the CPU");
  }
  return cpu;
}

}  // namespace gdtslam
