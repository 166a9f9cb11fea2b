#include "unit.hpp"

#include <memory>
#include <string>

#include "atlas_hash.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/runs/folder/report_reader.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/mapping/stopwatch.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "input.hpp"
#include "kept_run.hpp"
#include "thumbnail.hpp"
#include "work_folder.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kLongestReason = 500;

bool is_fault_of_the_log(ExitCode code) {
  return code == ExitCode::kBadInput || code == ExitCode::kUsage || code == ExitCode::kBadConfig;
}

MapRequest request_of(const UnitWork& work, const UnitInput& input, const std::string& folder) {
  const FleetPlan& plan = work.stored.plan;
  MapRequest request{
      .logs = {input.path}, .folder = folder, .settings = work.settings, .lenient = plan.reading.lenient};
  request.with_continue_file = false;
  if (!plan.linkage.empty()) {
    request.linkage = work.folder + "/linkage.yaml";
    write_file_atomically(request.linkage, plan.linkage);
  }
  // A unit that is stopped is dropped: nobody wants a part of it.
  request.stop = [&work] {
    if (work.stop && work.stop()) throw Error(ExitCode::kInterrupted, "interrupted");
    return false;
  };
  if (work.progress) request.progress = [&work](std::uint64_t, double share) { work.progress(share); };
  return request;
}

void read_figures(const std::string& run_folder, UnitRecord& record) {
  const ReportReader report = read_report(run_folder + "/report.json", run_folder);
  const GridGeometry map = report.geometry("gdt");
  record.figures = {.scans = report.whole("scans"),
                    .doubtful = report.whole("doubtful"),
                    .keyframes = report.whole("keyframes"),
                    .path_m = report.number("path_m"),
                    .log_duration_s = report.number("log_duration_s"),
                    .width_m = map.resolution_m * map.width,
                    .height_m = map.resolution_m * map.height};
}

// Without the name of the file, which may lie elsewhere on another node.
std::string reason_of(std::string message, const std::string& path) {
  if (message.starts_with(path)) message.erase(0, path.size());
  if (message.starts_with(": ")) {
    message.erase(0, 2);
  } else if (message.starts_with(':')) {
    message.replace(0, 1, "line ");
  }
  return table_text(message).substr(0, kLongestReason);
}

// The run folder below the work folder; nothing and a reason in the record where the log is refused.
bool map_or_refuse(const UnitWork& work, const UnitInput& input, const std::string& folder, UnitRecord& record) {
  try {
    write_thumbnail(folder, work.map(request_of(work, input, folder)).outcome);
    return true;
  } catch (const Error& error) {
    if (!is_fault_of_the_log(error.code())) throw;
    record.exit_code = static_cast<int>(error.code());
    record.reason = reason_of(error.what(), input.path);
    return false;
  }
}

bool map_unit(const UnitWork& work, const UnitInput& input, const std::string& folder, UnitRecord& record) {
  const bool is_mapped = map_or_refuse(work, input, folder, record);
  require_unchanged(work.stored.plan, input);
  return is_mapped;
}

UnitRecord record_of(const UnitWork& work) {
  UnitRecord record;
  record.plan = work.stored.id;
  record.unit = work.unit;
  record.uri = work.stored.plan.units.at(work.unit).uri;
  record.host = work.place.host;
  record.isa = work.place.isa;
  record.device = work.place.device;
  return record;
}

/// What a unit has before it is mapped.
UnitInput named_input(const UnitWork& work, UnitRecord& record) {
  const FleetPlan& plan = work.stored.plan;
  // A log that is fetched has a folder of its own: it may have the name of anything that is written here.
  const std::string fetched = work.folder + "/log";
  make_folder(fetched);
  UnitInput input = unit_input(plan, plan.units.at(work.unit), fetched, work.stop);
  record.bytes = input.bytes;
  record.input_sha256 = input.sha256;
  record.run = unit_name(plan, input);
  return input;
}

void take_results(const std::string& run_folder, UnitRecord& record) {
  read_figures(run_folder, record);
  record.result_sha256 = result_sha256_of(run_folder);
}

/// Of a run that lies in the atlas without its record.
void take_kept_results(const std::string& kept, const Settings& settings, UnitRecord& record) {
  require_run_of_plan(kept, settings);
  try {
    take_results(kept, record);
  } catch (const InputError& error) {
    throw FileError(kept, "is damaged: " + said_in_atlas(error.what()));
  }
}

}  // namespace

Settings plan_settings(const FleetPlan& plan) {
  Settings settings;
  settings.from_file = read_config_text(plan.config, kPlanFile, option_table(settings));
  require_valid(settings);
  return settings;
}

UnitRecord compute_unit(const UnitWork& work) {
  UnitRecord record = record_of(work);
  const UnitInput input = named_input(work, record);
  const std::string run_folder = work.folder + "/run";
  if (map_unit(work, input, run_folder, record)) take_results(run_folder, record);
  return record;
}

UnitRecord do_unit(const UnitWork& work) {
  Stopwatch watch;
  UnitRecord record = record_of(work);
  require_file_or_nothing(work.atlas + "/" + record_path(work.unit));
  const UnitInput input = named_input(work, record);
  const std::string kept = work.atlas + "/" + run_path(record.run);
  if (!is_run_there(kept)) {
    const std::string run_folder = work.folder + "/run";
    if (map_unit(work, input, run_folder, record)) {
      take_results(run_folder, record);
      require_same_atlas(work.atlas, work.stored);
      move_into_atlas(run_folder, work.atlas, record.run, work.staging);
    }
  } else {
    take_kept_results(kept, work.settings, record);
  }
  watch.add_to(record.wall_s, record.cpu_s);
  require_same_atlas(work.atlas, work.stored);
  write_record(work.atlas, record);
  return record;
}

}  // namespace gdtslam
