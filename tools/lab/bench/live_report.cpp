#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/core/quantile.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "live.hpp"

namespace gdtslam {
namespace {

using LiveJson = nlohmann::ordered_json;

constexpr double kLong_s = 0.05;  // of a scan, for whoever steers by its pose
constexpr std::size_t kParts = 10;
constexpr std::size_t kWorst = 10;

double milliseconds(double seconds) { return 1.0e3 * seconds; }

/// Times of all scans, to be asked for shares.
struct LiveTimes {
  std::vector<double> all_s;
  std::vector<double> cpu_s;
  std::size_t above_50_ms = 0;
};

LiveTimes times_of(const std::vector<LiveScan>& scans) {
  LiveTimes times;
  times.all_s.reserve(scans.size());
  times.cpu_s.reserve(scans.size());
  for (const LiveScan& scan : scans) {
    times.all_s.push_back(scan.all_s);
    times.cpu_s.push_back(scan.cpu_s);
    if (scan.all_s > kLong_s) ++times.above_50_ms;
  }
  return times;
}

/// The first of the slowest by the clock, with what it did.
const LiveScan& slowest(const std::vector<LiveScan>& scans) {
  return *std::max_element(scans.begin(), scans.end(),
                           [](const LiveScan& a, const LiveScan& b) { return a.all_s < b.all_s; });
}

/// Those that took the most CPU time, the worst first.
std::vector<LiveScan> worst_of(std::vector<LiveScan> scans) {
  const std::size_t count = std::min(kWorst, scans.size());
  const auto end = scans.begin() + static_cast<std::ptrdiff_t>(count);
  std::partial_sort(scans.begin(), end, scans.end(), [](const LiveScan& a, const LiveScan& b) {
    return std::pair(b.cpu_s, a.index) < std::pair(a.cpu_s, b.index);
  });
  scans.resize(count);
  return scans;
}

std::string shares_text(std::vector<double>& times_s) {
  const auto share = [&times_s](double s) { return milliseconds(value_at_share(times_s, s)); };
  return fmt::format("median {:.2f}, 90 % {:.2f}, 99 % {:.2f}, 99.9 % {:.2f}, largest {:.2f}", share(0.5), share(0.9),
                     share(0.99), share(0.999), share(1.0));
}

std::string stages_text(const LiveScan& scan) {
  return fmt::format("scan {}{}: match {:.2f} ms, local field {:.2f} ms, merge {:.2f} ms", scan.index,
                     scan.is_keyframe ? ", a keyframe" : "", milliseconds(scan.stages.match_s),
                     milliseconds(scan.stages.local_field_s), milliseconds(scan.stages.merge_s));
}

std::string tables_text(const LiveBench& bench) {
  std::string text = "CPU ms    worst scans; windows searched, poses costed\n";
  for (const LiveScan& scan : worst_of(bench.scans)) {
    text += fmt::format("{:9.2f} {}; {}, {}\n", milliseconds(scan.cpu_s), stages_text(scan), scan.windows,
                        scan.evaluations);
  }
  text += "CPU ms    a keyframe, of that its merge; another scan; over the log\n";
  for (const LivePart& part : live_parts(bench.scans, kParts)) {
    text += fmt::format("{:9.3f} {:.3f}; {:.3f}; scans {} to {}, {} keyframes\n", milliseconds(part.keyframe_cpu_s),
                        milliseconds(part.keyframe_merge_s), milliseconds(part.scan_cpu_s), part.first,
                        part.first + part.scans - 1, part.keyframes);
  }
  return text;
}

std::string live_text(const LiveBenchJob& job, const LiveBench& bench, const Backend& backend) {
  const bool is_beside = job.loops && job.options.loops_beside;
  std::string text =
      fmt::format("gdtslam {}\ncpu       {}, {}, {}\n", GDTSLAM_VERSION, backend.device().name,
                  to_string(backend.host_isa()), is_beside ? "one thread, loops beside it" : "one thread");
  const std::string name = log_name(job.log);
  text += fmt::format("{}: {} scans, {} of them keyframes, in {:.1f} s{}; {} came while the one before was at work\n",
                      name.substr(name.rfind('/') + 1), bench.scans.size(), bench.keyframes, bench.lasted_s,
                      job.speed > 0.0 ? fmt::format(", {:g} times as fast as recorded", job.speed) : "", bench.late);
  LiveTimes times = times_of(bench.scans);
  text += fmt::format("scan ms   {}; above 50 ms {}\n", shares_text(times.all_s), times.above_50_ms);
  text += fmt::format("CPU ms    {}\n", shares_text(times.cpu_s));
  const LiveScan& worst = slowest(bench.scans);
  text += fmt::format("largest   {}, waited {:.2f} ms for loops\n", stages_text(worst), milliseconds(worst.waited_s));
  if (job.loops) {
    text += fmt::format("loops     {} places, {} corrections; waited {} times, {:.3f} s; {:.1f} s of CPU time beside\n",
                        bench.loops.places, bench.loops.corrections, bench.loops.waits, bench.loops.waited_s,
                        bench.loops.beside_cpu_s);
  }
  return text + fmt::format("memory    {:.0f} MB at most\n", 1.0e-6 * static_cast<double>(bench.peak_bytes)) +
         tables_text(bench);
}

LiveJson json_of(const LiveScan& scan) {
  return {{"scan", scan.index},
          {"keyframe", scan.is_keyframe},
          {"all_s", scan.all_s},
          {"cpu_s", scan.cpu_s},
          {"match_s", scan.stages.match_s},
          {"local_field_s", scan.stages.local_field_s},
          {"merge_s", scan.stages.merge_s},
          {"waited_s", scan.waited_s},
          {"windows", scan.windows},
          {"evaluations", scan.evaluations}};
}

LiveJson parts_json(const LiveBench& bench) {
  LiveJson parts = LiveJson::array();
  for (const LivePart& part : live_parts(bench.scans, kParts)) {
    parts.push_back({{"first", part.first},
                     {"scans", part.scans},
                     {"keyframes", part.keyframes},
                     {"scan_cpu_s", part.scan_cpu_s},
                     {"keyframe_cpu_s", part.keyframe_cpu_s},
                     {"keyframe_merge_s", part.keyframe_merge_s}});
  }
  return parts;
}

LiveJson loops_json(const LiveBenchJob& job, const LiveStatistics& loops) {
  if (!job.loops) return nullptr;
  return {{"places", loops.places},
          {"corrections", loops.corrections},
          {"waits", loops.waits},
          {"waited_s", loops.waited_s},
          {"beside_cpu_s", loops.beside_cpu_s}};
}

void add_shares(LiveJson& json, std::vector<double>& times_s) {
  json["median_s"] = value_at_share(times_s, 0.5);
  json["p90_s"] = value_at_share(times_s, 0.9);
  json["p99_s"] = value_at_share(times_s, 0.99);
  json["p999_s"] = value_at_share(times_s, 0.999);
}

std::string live_json(const LiveBenchJob& job, const LiveBench& bench, const Backend& backend) {
  const std::string name = log_name(job.log);
  LiveTimes times = times_of(bench.scans);
  double busy_s = 0.0;
  for (const double all_s : times.all_s) busy_s += all_s;
  LiveJson report{{"version", GDTSLAM_VERSION},
                  {"device", backend.device().name},
                  {"isa", to_string(backend.host_isa())},
                  {"log", name.substr(name.rfind('/') + 1)},
                  {"speed", job.speed},
                  {"loops_beside", job.loops && job.options.loops_beside},
                  {"scans", bench.scans.size()},
                  {"keyframes", bench.keyframes},
                  {"late", bench.late},
                  {"lasted_s", bench.lasted_s},
                  {"busy_s", busy_s},
                  {"peak_bytes", bench.peak_bytes}};
  add_shares(report, times.all_s);
  report["above_50_ms"] = times.above_50_ms;
  report["largest"] = json_of(slowest(bench.scans));
  report["cpu"] = LiveJson::object();
  add_shares(report["cpu"], times.cpu_s);
  report["cpu"]["largest_s"] = value_at_share(times.cpu_s, 1.0);
  report["worst"] = LiveJson::array();
  for (const LiveScan& scan : worst_of(bench.scans)) report["worst"].push_back(json_of(scan));
  report["parts"] = parts_json(bench);
  report["loops"] = loops_json(job, bench.loops);
  return json_text(report);
}

}  // namespace

std::string bench_live(const LiveBenchJob& job, Backend& backend, const std::function<bool()>& stop, bool is_json) {
  const LiveBench bench = run_live(job, backend, stop);
  return is_json ? live_json(job, bench, backend) : live_text(job, bench, backend);
}

}  // namespace gdtslam
