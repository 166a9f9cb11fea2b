#include "device_option.hpp"

#include <fmt/format.h>
#include <CLI/App.hpp>

#include <string>
#include <string_view>
#include <vector>

#include "engine/core/ascii.hpp"
#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

constexpr unsigned kMostThreads = 1024;

constexpr std::size_t kMostDigits = 4;

[[noreturn]] void refuse(const std::string& name) {
  const std::vector<std::string> names{"auto", "cpu", "vulkan"};
  const bool is_gpu = name.starts_with("gpu") || name.starts_with("GPU");  // by edit distance it is nearer to cpu
  throw UsageError("--device: there is no device '" + name + "'" + did_you_mean(is_gpu ? "vulkan" : name, names) +
                   " (auto, cpu, vulkan or vulkan:N)");
}

unsigned index_from(std::string_view digits, const std::string& name) {
  if (!is_digits(digits) || digits.size() > kMostDigits) refuse(name);
  unsigned index = 0;
  for (const char digit : digits) index = index * 10 + static_cast<unsigned>(digit - '0');
  return index;
}

std::string to_string(const DeviceName& name) {
  return name.index ? fmt::format("vulkan:{}", *name.index) : std::string("vulkan");
}

std::string list_devices(const VulkanListing& listing) {
  std::string text;
  for (const VulkanDeviceInfo& device : listing.devices) {
    text += fmt::format("{}vulkan:{} ({}{}{})", text.empty() ? "" : ", ", device.index, device.name,
                        device.problem.empty() ? "" : ": ", device.problem);
  }
  return text;
}

const VulkanDeviceInfo* numbered(const VulkanListing& listing, unsigned index) {
  for (const VulkanDeviceInfo& device : listing.devices) {
    if (device.index == index) return &device;
  }
  return nullptr;
}

const VulkanDeviceInfo* first_usable(const VulkanListing& listing, bool hardware_only) {
  for (const VulkanDeviceInfo& device : listing.devices) {
    if (device.problem.empty() && (device.is_hardware() || !hardware_only)) return &device;
  }
  return nullptr;
}

[[noreturn]] void fail(const DeviceName& name, const std::string& why) {
  throw UnavailableError("--device " + to_string(name) + ": " + why + "; --device cpu gives the same results");
}

unsigned named_device(const DeviceName& name, const VulkanListing& listing) {
  if (listing.devices.empty()) throw UnavailableError("--device " + to_string(name) + ": " + listing.problem);
  if (!name.index) {
    const VulkanDeviceInfo* device = first_usable(listing, true);
    if (device == nullptr) device = first_usable(listing, false);
    if (device == nullptr) fail(name, "no device can be used: " + list_devices(listing));
    return device->index;
  }
  const VulkanDeviceInfo* const device = numbered(listing, *name.index);
  if (device == nullptr) fail(name, "there is no such device, only " + list_devices(listing));
  if (!device->problem.empty()) fail(name, device->name + " cannot be used: " + device->problem);
  return device->index;
}

std::vector<std::string> isa_names() {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < kIsaCount; ++k) names.emplace_back(to_string(static_cast<Isa>(k)));
  return names;
}

}  // namespace

void add_device_options(CLI::App& command, DeviceOptions& options, bool with_fallback, bool with_isa) {
  command
      .add_option("--device", options.device,
                  "Where to compute: auto (a GPU where it is faster, else the CPU), cpu, vulkan or vulkan:N;\n"
                  "'gdtslam doctor --devices' lists them. Results do not depend on it")
      ->type_name("NAME")
      ->capture_default_str();
  offer_words(command.get_option("--device"), {"auto", "cpu", "vulkan"});
  command
      .add_option("--threads", options.threads,
                  "Threads of the CPU, 0 for one per processor. Results do not depend on it")
      ->type_name("N")
      ->each([&options](const std::string&) { options.are_threads_given = true; })
      ->transform(without_leading_zeros())
      ->check(CLI::Range(0U, kMostThreads))
      ->capture_default_str();
  if (with_isa) {
    command
        .add_option("--isa", options.isa,
                    "Force the CPU's instruction set: baseline, avx2 or avx512. Results do not depend on it")
        ->type_name("NAME");
    offer_words(command.get_option("--isa"), isa_names());
  }
  if (!with_fallback) return;
  command.add_flag("--no-fallback", options.no_fallback,
                   "Fail (exit 1, with the call of the driver) rather than go on with the CPU when the device fails");
}

Isa isa_from_name(const std::string& name) {
  const std::vector<std::string> names = isa_names();
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (name == names[k]) return static_cast<Isa>(k);
  }
  throw UsageError("--isa: there is no instruction set '" + name + "'" + did_you_mean(name, names) +
                   " (baseline, avx2 or avx512)");
}

CpuOptions cpu_options(const DeviceOptions& options) {
  CpuOptions cpu{.threads = options.threads, .isa = {}};
  if (!options.isa.empty()) cpu.isa = isa_from_name(options.isa);
  return cpu;
}

std::unique_ptr<Backend> make_cpu(const DeviceOptions& options) { return make_cpu_backend(cpu_options(options)); }

std::unique_ptr<VulkanBackend> make_vulkan(const DeviceOptions& options, VulkanOptions wanted) {
  const DeviceName name = parse_device_name(options.device);
  if (name.kind == DeviceName::Kind::kCpu) return nullptr;
  wanted.index = choose_device(name, list_vulkan_devices());
  if (!wanted.index) return nullptr;
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

BackendWhenNeeded::BackendWhenNeeded(const DeviceOptions& options)
    : options_(options),
      is_chosen_(parse_device_name(options.device).kind != DeviceName::Kind::kAuto),
      backend_(is_chosen_ ? make_backend(options) : make_cpu(options)) {}

Backend& BackendWhenNeeded::of(bool has_work) {
  if (!is_chosen_ && has_work) backend_ = make_backend(options_);
  is_chosen_ = true;
  return *backend_;
}

DeviceName parse_device_name(const std::string& name) {
  constexpr std::string_view kNumbered = "vulkan:";
  if (name == "auto") return {DeviceName::Kind::kAuto, {}};
  if (name == "cpu") return {DeviceName::Kind::kCpu, {}};
  if (name == "vulkan") return {DeviceName::Kind::kVulkan, {}};
  if (!name.starts_with(kNumbered)) refuse(name);
  return {DeviceName::Kind::kVulkan, index_from(std::string_view(name).substr(kNumbered.size()), name)};
}

std::optional<unsigned> choose_device(const DeviceName& name, const VulkanListing& listing) {
  if (name.kind == DeviceName::Kind::kCpu) return std::nullopt;
  if (name.kind == DeviceName::Kind::kVulkan) return named_device(name, listing);
  const VulkanDeviceInfo* const device = first_usable(listing, true);
  return device == nullptr ? std::nullopt : std::optional(device->index);
}

MapperOptions on_failure_of(const DeviceOptions& options) {
  return {.fall_back = !options.no_fallback,
          .cpu = cpu_options(options),
          .warn = [](const std::string& text) { print_remark("warning: " + text); },
          .loops_beside = options.threads != 1 || !options.are_threads_given};
}

}  // namespace gdtslam
