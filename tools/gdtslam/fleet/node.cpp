#include "node.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/fleet/record.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/gdtslam/shell/workers.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

/// What the sample log became here.
struct SampleResult {
  std::string map_sha256;
  std::string trajectory_sha256;
  std::string processor;
  UnitPlace place;
};

// In a process of its own, as all that may open a device.
std::string map_sample(const DeviceOptions& device, const std::string& folder) {
  MapRequest request{.logs = {sample_log_file()}, .folder = folder};
  request.settings.log.odometry_stamps = OdometryStamps::kLog;  // they are right, and finding that out takes seconds
  request.with_continue_file = false;
  request.with_map = false;
  request.with_pictures = false;
  request.on_failure = on_failure_of(device);
  request.stop = [] { return interrupted(); };
  const DeviceInfo cpu = make_cpu(device)->device();
  BackendWhenNeeded backend(device);
  const MapResult result = map_logs(request, [&backend](bool has_work) -> Backend& { return backend.of(has_work); });
  if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted");
  const Json report = Json::parse(result.report);
  const Json& used = report.at("device");
  return Json{{"map_sha256", report.at("map_sha256")},
              {"trajectory_sha256", report.at("trajectory_sha256")},
              {"processor", cpu.name},
              {"isa", cpu.driver},
              {"device", used.at("kind") == "cpu"
                             ? "cpu"
                             : used.at("name").get<std::string>() + ", " + used.at("driver").get<std::string>()}}
      .dump();
}

SampleResult sample_result(const DeviceOptions& device, const std::string& folder) {
  Workers worker(1);
  worker.start(0, [&](const Workers::Tell&) { return map_sample(device, folder); });
  Workers::Event event;
  while (!event.result) event = worker.wait();
  const Json said = Json::parse(*event.result);
  return {said.at("map_sha256"),
          said.at("trajectory_sha256"),
          said.at("processor"),
          {.host = host_name(), .isa = said.at("isa"), .device = said.at("device")}};
}

void write_node(const StoredPlan& stored, const std::string& atlas, const SampleResult& result, bool agrees) {
  require_same_atlas(atlas, stored);
  make_folder(atlas + "/nodes");
  const std::string file = atlas + "/nodes/" + result.place.host + ".json";
  require_file_or_nothing(file);
  write_json(file, {{"format", kAtlasFormat},
                    {"plan", stored.id},
                    {"host", result.place.host},
                    {"version", GDTSLAM_VERSION},
                    {"processor", result.processor},
                    {"processors", usable_processors()},
                    {"isa", result.place.isa},
                    {"device", result.place.device},
                    {"sample_map_sha256", result.map_sha256},
                    {"sample_trajectory_sha256", result.trajectory_sha256},
                    {"agrees", agrees}});
}

}  // namespace

FleetProgram this_program() {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
  const std::string file = asset_file("expected", "office-start.json");
  const Json json = read_json(file, kMostBytes, "; install gdtslam again");
  try {
    for (const Json& run : json.at("runs")) {
      if (!run.at("loops").get<bool>()) continue;
      return {GDTSLAM_VERSION, run.at("map_sha256"), run.at("trajectory_sha256")};
    }
  } catch (const Json::exception&) {  // as one that has no such run
  }
  throw InputError({file, 0}, "is damaged; install gdtslam again");
}

std::string host_name() {
  std::array<char, 256> name{};
  const char* const node = std::getenv("SLURMD_NODENAME");
  if (node == nullptr && ::gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  std::string host = node != nullptr ? node : name.data();
  for (char& c : host) {
    const bool is_plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
    if (!is_plain) c = '_';
  }
  return host.empty() || host.front() == '.' ? "unknown" : host;
}

unsigned usable_processors() {
  const char* const stated = std::getenv("SLURM_CPUS_PER_TASK");
  unsigned count = 0;
  if (stated != nullptr) {
    const std::string_view text = stated;
    if (std::from_chars(text.data(), text.data() + text.size(), count).ec == std::errc{} && count > 0) return count;
  }
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof set, &set) == 0) return static_cast<unsigned>(std::max(1, CPU_COUNT(&set)));
  return std::max(1U, std::thread::hardware_concurrency());
}

UnitPlace checked_node(const StoredPlan& stored, const std::string& atlas, const DeviceOptions& device,
                       const std::string& folder) {
  const FleetProgram& program = stored.plan.program;
  if (program.version != GDTSLAM_VERSION) {
    throw Error(ExitCode::kOtherResults,
                fmt::format("{}: this is gdtslam {}, and the plan is of {}: install that one here", host_name(),
                            GDTSLAM_VERSION, program.version));
  }
  const SampleResult result = sample_result(device, folder);
  const bool agrees =
      result.map_sha256 == program.sample_map_sha256 && result.trajectory_sha256 == program.sample_trajectory_sha256;
  if (!atlas.empty()) write_node(stored, atlas, result, agrees);
  if (agrees) return result.place;
  throw Error(
      ExitCode::kOtherResults,
      fmt::format("{} refuses to work: the sample log becomes map {} and path {} here ({}, {}), and {} and {} in "
                  "the plan; 'gdtslam verify' says more",
                  host_name(), result.map_sha256.substr(0, 12), result.trajectory_sha256.substr(0, 12),
                  result.place.isa, result.place.device, program.sample_map_sha256.substr(0, 12),
                  program.sample_trajectory_sha256.substr(0, 12)));
}

DeviceOptions of_one_thread(DeviceOptions device) {
  device.threads = 1;
  device.are_threads_given = true;
  return device;
}

}  // namespace gdtslam
