// gdtslam convert: a log or a cloud in another format.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/writers/log_writer.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "tools/gdtslam/convert/clouds.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

struct ConvertOptions {
  std::vector<std::string> inputs;
  std::string log;  ///< the only input, if it is a log
  std::string output;
  double cell_m = 0.25;
  double spacing_m = 0.05;
  std::string format;
  std::string compression;
  RecordingOptions recording;
  SettingsOptions settings;
  bool lenient = false;
  bool force = false;
  bool json = false;
  bool quiet = false;
};

/// Numbers of records written and scans read.
struct ConvertCounts {
  std::uint64_t scans_read = 0;
  std::uint64_t scans = 0;
  std::uint64_t odometry = 0;
  std::uint64_t crank = 0;
  std::uint64_t parameters = 0;
  bool is_whole = true;
};

std::optional<ChunkPacking> packing_named(const std::string& name) {
  if (name.empty()) return std::nullopt;
  for (const auto& [text, packing] : {std::pair("none", ChunkPacking::kNone), std::pair("lz4", ChunkPacking::kLz4),
                                      std::pair("zstd", ChunkPacking::kZstd)}) {
    if (name == text) return packing;
  }
  throw UsageError(fmt::format("--compression: {} is none of none, lz4, zstd", in_quotes(name)));
}

// Refuses settings that have no effect on the written log.
void require_useful(const Settings& settings) {
  for (const std::string& path : settings.from_sets) {
    if (path.starts_with("log.") && !path.starts_with("log.odometry_")) continue;
    throw UsageError(
        fmt::format("--set: convert has no use for {}: it takes what log.* states of scans, clock and "
                    "crank, and leaves odometry as it is",
                    path));
  }
}

void count_record(const LogRecord& record, ConvertCounts& counts) {
  if (std::holds_alternative<ScanRecord>(record)) ++counts.scans;
  if (std::holds_alternative<Odometry>(record)) ++counts.odometry;
  if (std::holds_alternative<Encoder>(record) || std::holds_alternative<Tilt>(record)) ++counts.crank;
  if (std::holds_alternative<Parameter>(record)) ++counts.parameters;
}

ConvertCounts copy_records(LogReader& reader, const ReadOptions& read, LogWriter& writer, bool quiet) {
  ConvertCounts counts;
  ProgressLine progress("scans", quiet);
  while (std::optional<LogRecord> record = reader.next()) {
    if (auto* const scan = std::get_if<ScanRecord>(&*record)) {
      ++counts.scans_read;
      state_beam_times(read, scan->scan);
    }
    if (writer.write(*record)) count_record(*record, counts);
    progress.update(counts.scans_read, reader.progress());
    if (interrupted()) break;
  }
  counts.is_whole = !interrupted();  // a signal ends standard input like its writer
  return counts;
}

Json warnings_json(const std::vector<LogReader::Warning>& warnings) {
  Json list = Json::array();
  for (const LogReader::Warning& one : warnings) {
    list.push_back({{"kind", one.kind}, {"count", one.count}, {"first", one.first}});
  }
  return list;
}

void print_left_out(const std::vector<LogReader::Warning>& left_out) {
  for (const LogReader::Warning& one : left_out) {
    print_remark(fmt::format("the format cannot carry: {} ({} times; first: {})", one.kind, one.count, one.first));
  }
}

std::string counts_text(const ConvertCounts& counts, std::uint64_t bytes, const std::string& output) {
  return fmt::format("{}, {} odometry, {} of the crank, {}; {:.1f} MB in {}\n", plural(counts.scans, "scan"),
                     counts.odometry, counts.crank, plural(counts.parameters, "parameter"),
                     1e-6 * static_cast<double>(bytes), output);
}

// A log may have no scans by intent, but not because all were lost.
void require_scans(const ConvertOptions& options, const ConvertCounts& counts, const LogWriter& writer) {
  if (counts.scans > 0 || counts.scans_read == 0) return;
  const auto& left_out = writer.left_out();
  const auto is_rarer = [](const LogReader::Warning& a, const LogReader::Warning& b) { return a.count < b.count; };
  const LogReader::Warning& why = *std::max_element(left_out.begin(), left_out.end(), is_rarer);
  throw InputError(
      {log_name(options.log), 0},
      fmt::format("the format can carry none of its {} scans: {} ({} times; first: {}); nothing is written",
                  counts.scans_read, why.kind, why.count, why.first));
}

int convert(const ConvertOptions& options) {
  const LogFormat format = find_log_format(options.output, options.format);
  const std::optional<ChunkPacking> packing = packing_named(options.compression);
  WrittenFiles({options.log, options.settings.file}, options.force).add("--output", options.output);
  Settings settings = load_settings(options.settings);
  require_useful(settings);
  state_recording(options.recording, settings.log);
  const ReadOptions read = read_options_of(settings.log, options.lenient);
  const std::unique_ptr<LogReader> reader = open_log(options.log, read);
  AtomicFileSet files;
  const std::unique_ptr<LogWriter> writer = make_log_writer(format, options.output, packing, files);
  const ConvertCounts counts = copy_records(*reader, read, *writer, options.quiet);
  require_scans(options, counts, *writer);
  writer->finish();
  files.commit();
  if (!options.quiet) {
    print_warnings(reader->warnings());
    print_left_out(writer->left_out());
  }
  const bool is_stdout_free = options.output != "-";
  if (options.json && is_stdout_free) {
    print_result(json_text({{"log", options.log},
                            {"output", options.output},
                            {"scans", counts.scans},
                            {"odometry", counts.odometry},
                            {"crank", counts.crank},
                            {"parameters", counts.parameters},
                            {"bytes", writer->bytes()},
                            {"warnings", warnings_json(reader->warnings())},
                            {"left_out", warnings_json(writer->left_out())},
                            {"interrupted", !counts.is_whole}}));
  } else if (!options.quiet && is_stdout_free) {
    print_result(counts_text(counts, writer->bytes(), printable(options.output)));
  }
  if (counts.is_whole) return static_cast<int>(ExitCode::kDone);
  print_remark(fmt::format("interrupted after {}, which {} written", plural(counts.scans, "scan"),
                           counts.scans == 1 ? "was" : "were"));
  return static_cast<int>(ExitCode::kInterrupted);
}

int convert_cloud(const ConvertOptions& options) {
  WrittenFiles(options.inputs, options.force).add("--output", options.output);
  const ConvertedClouds result = convert_clouds(options.inputs, options.output, options.cell_m, options.spacing_m);
  if (options.json) {
    print_result(json_text({{"inputs", options.inputs},
                            {"output", options.output},
                            {"points", result.points},
                            {"cubes", result.cubes},
                            {"cell_m", result.cell_m},
                            {"deviation_m", result.deviation_m},
                            {"bytes", result.bytes}}));
  } else if (!options.quiet) {
    print_result(fmt::format("{}{}; {:.1f} MB in {}\n", plural(result.points, "point"),
                             result.cubes == 0
                                 ? ""
                                 : fmt::format(", {} of {:g} m, {:.1f} mm from their planes (rms)",
                                               plural(result.cubes, "cube"), result.cell_m, 1e3 * result.deviation_m),
                             1e-6 * static_cast<double>(result.bytes), printable(options.output)));
  }
  return static_cast<int>(ExitCode::kDone);
}

// The inputs are clouds, or one log.
int convert_inputs(ConvertOptions& options) {
  const auto clouds =
      static_cast<std::size_t>(std::count_if(options.inputs.begin(), options.inputs.end(), is_cloud_name));
  if (clouds == options.inputs.size() && is_cloud_name(options.output)) return convert_cloud(options);
  if (clouds > 0 || is_cloud_name(options.output)) {
    throw UsageError("a cloud (.ply, .pcd, .ndt) becomes a cloud and a log becomes a log; map makes a cloud of a log");
  }
  if (options.inputs.size() > 1) throw UsageError("one log is converted at a time; give one, or clouds to be joined");
  options.log = options.inputs.front();
  return convert(options);
}

// The reader of standard output may close early, like `head`.
int convert_for_reader(ConvertOptions& options) {
  try {
    return convert_inputs(options);
  } catch (const NoReaderError&) {
    if (options.output != "-") throw;
    return static_cast<int>(interrupted() ? ExitCode::kInterrupted : ExitCode::kDone);  // Ctrl-C ends both
  }
}

}  // namespace

void add_convert_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command =
      add_command(app, "convert", "A log or clouds in another format: CARMEN, CSV, JSON lines, MCAP; PLY, PCD, NDT");
  command
      ->add_option(
          "input", options->inputs,
          fmt::format("{} log, plain or packed; - is standard input. Or clouds of one frame, which are joined:\n"
                      ".ply, .pcd, or .ndt, the normal distributions of cubes",
                      kLogFormats))
      ->required()
      ->type_name("INPUT");
  command
      ->add_option(
          "-o,--output", options->output,
          "The log to write. Its ending tells the format: .log or .clf (CARMEN), .csv, .jsonl, .mcap; .gz after "
          "it packs it; - is standard output. Or the cloud to write: .ply, .pcd, .ndt")
      ->required()
      ->type_name("OUT");
  CLI::Option* const format = command->add_option(
      "--format", options->format, "Format of OUT, where its name does not tell it: " + log_format_names());
  offer_words(format->type_name("NAME"), {"carmen", "csv", "jsonl", "mcap"});
  command
      ->add_option("--compression", options->compression,
                   "Compression of the chunks of an MCAP file: none, lz4 or zstd\n"
                   "[zstd]")
      ->type_name("NAME");
  offer_words(command->get_option("--compression"), {"none", "lz4", "zstd"});
  add_quantity_option(*command, "--cell", options->cell_m, Unit::kMetre, {1.0e-3, 1.0e3},
                      "Edge of the cubes of an .ndt file");
  add_quantity_option(*command, "--spacing", options->spacing_m, Unit::kMetre, {1.0e-3, 1.0e3},
                      "Distance of the points that are sampled of an .ndt file");
  command->add_flag("--lenient", options->lenient, "Count and skip malformed lines instead of failing");
  add_recording_options(*command, options->recording);
  add_settings_options(*command, options->settings);
  add_force_option(*command, options->force);
  command->add_flag("--json", options->json, "Print what was written as JSON");
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "What the target cannot carry is counted on standard error. CSV and JSON lines carry every number of a log, so\n"
      "that it gives the same map, byte for byte; bearings are 32-bit numbers in ROS.\n"
      "\n"
      "Examples:\n"
      "  gdtslam convert intel.clf.gz -o intel.mcap\n"
      "  gdtslam convert drive.bag -o drive.csv.gz --topic /front/scan\n"
      "  gdtslam convert office.log -o - --format jsonl | head -n 1\n"
      "  gdtslam convert office/cloud.ply -o office.ndt --cell 50cm");
  command->callback([options, &context] { context.run = [options] { return convert_for_reader(*options); }; });
}

}  // namespace gdtslam
