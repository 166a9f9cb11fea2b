// gdtslam devices: what can compute here.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "console.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/json_file.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

bool is_available(Isa isa) {
  try {
    make_cpu_backend({.threads = 1, .isa = isa});
    return true;
  } catch (const UnavailableError&) {
    return false;
  }
}

int devices(bool json) {
  const std::unique_ptr<Backend> cpu = make_cpu_backend({.threads = 0, .isa = {}});
  Json variants = Json::array();
  std::string text = fmt::format("cpu      {}\n", cpu->device().name);
  text += fmt::format("         {} threads, {}\n", cpu->device().threads, cpu->device().driver);
  for (std::size_t k = 0; k < kIsaCount; ++k) {
    const Isa isa = static_cast<Isa>(k);
    const bool available = is_available(isa);
    const char* const state = isa == best_isa() ? "used by default" : available ? "available" : "not on this machine";
    variants.push_back({{"name", name_of(isa)}, {"available", available}, {"default", isa == best_isa()}});
    text += fmt::format("         --isa {:<9} {}\n", name_of(isa), state);
  }
  text += "vulkan   this build has no Vulkan backend\n";
  const Json report{{"devices", Json::array({{{"device", "cpu"},
                                              {"name", cpu->device().name},
                                              {"driver", cpu->device().driver},
                                              {"threads", cpu->device().threads},
                                              {"isa", variants}}})},
                    {"vulkan", {{"built", false}, {"devices", Json::array()}}}};
  print_result(json ? json_text(report) : text);
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_devices_command(CLI::App& app, CommandContext& context) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("devices", "What can compute here: processor, instruction sets, GPUs");
  command->add_flag("--json", *json, "Print JSON");
  command->footer("Examples:\n  gdtslam devices\n  gdtslam devices --json");
  command->callback([json, &context] { context.run = [json] { return devices(*json); }; });
}

}  // namespace gdtslam
