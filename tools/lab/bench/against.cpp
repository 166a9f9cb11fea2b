#include "against.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "engine/io/json_file.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBenchBytes = std::size_t{16} << 20U;
constexpr std::size_t kMostBenchSamples = 1000;  // of a row, as --samples allows
constexpr const char* kBenchAdvice = "; give what 'gdtslam bench --json' printed";

[[noreturn]] void refuse_bench(const std::string& file, const std::string& what) {
  throw InputError(FilePosition{file, 0}, what + kBenchAdvice);
}

std::string bench_word(const Json& object, const char* key, const std::string& file) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string()) refuse_bench(file, fmt::format("has no text '{}'", key));
  return found->get<std::string>();
}

EarlierRow earlier_row(const Json& json, const std::string& file) {
  if (!json.is_object()) refuse_bench(file, "has a row that is no object");
  EarlierRow row{{bench_word(json, "on", file), bench_word(json, "group", file), bench_word(json, "name", file),
                  bench_word(json, "variant", file)},
                 bench_word(json, "basis", file),
                 {}};
  const auto samples = json.find("samples_s");
  if (samples == json.end() || !samples->is_array() || samples->empty() || samples->size() > kMostBenchSamples) {
    refuse_bench(file, fmt::format("has no 1 to {} samples_s in a row", kMostBenchSamples));
  }
  row.samples_s.reserve(samples->size());
  for (const Json& sample : *samples) {
    const double seconds = sample.is_number() ? sample.get<double>() : 0.0;
    if (!(seconds > 0.0 && std::isfinite(seconds))) refuse_bench(file, "has a sample that is no time above 0");
    row.samples_s.push_back(seconds);
  }
  return row;
}

EarlierDevice earlier_device(const Json& json, const std::string& file) {
  if (!json.is_object()) refuse_bench(file, "has a device that is no object");
  return {bench_word(json, "device", file), bench_word(json, "name", file),
          json.contains("isa") ? bench_word(json, "isa", file) : ""};
}

std::string words_of(const EarlierDevice& device) {
  return printable(device.isa.empty() ? device.name : fmt::format("{} with {}", device.name, device.isa));
}

RowName name_of(const Measured& measured, const BenchRow& row) {
  return {measured.name, row.group, row.name, row.variant};
}

std::string words_of(const RowName& name) {
  return printable(
      fmt::format("{} {} {}{}{}", name.on, name.group, name.name, name.variant.empty() ? "" : " ", name.variant));
}

Json name_json(const RowName& name) {
  return {{"on", name.on}, {"group", name.group}, {"name", name.name}, {"variant", name.variant}};
}

Json names_json(const std::vector<RowName>& names) {
  Json list = Json::array();
  for (const RowName& name : names) list.push_back(name_json(name));
  return list;
}

}  // namespace

EarlierBench read_bench(const std::string& file) {
  const Json json = read_json(file, kMostBenchBytes, kBenchAdvice);
  if (!json.is_object()) refuse_bench(file, "is no object");
  EarlierBench bench{file, bench_word(json, "version", file), {}, {}};
  const auto rows = json.find("rows");
  if (rows == json.end() || !rows->is_array()) refuse_bench(file, "has no rows");
  bench.rows.reserve(rows->size());
  for (const Json& row : *rows) bench.rows.push_back(earlier_row(row, file));
  const auto devices = json.find("devices");
  if (devices == json.end() || !devices->is_array()) refuse_bench(file, "has no devices");
  for (const Json& device : *devices) bench.devices.push_back(earlier_device(device, file));
  return bench;
}

Against compare_with(const EarlierBench& before, const std::vector<Measured>& now) {
  Against against{before.file, before.version, {}, {}, {}};
  std::vector<bool> is_met(before.rows.size(), false);
  for (const Measured& measured : now) {
    for (const BenchRow& row : measured.rows) {
      const RowName name = name_of(measured, row);
      const Basis basis = basis_of(row.timing, measured.basis);
      const auto found = std::find_if(before.rows.begin(), before.rows.end(), [&](const EarlierRow& earlier) {
        return earlier.name == name && earlier.basis == to_string(basis);
      });
      if (found == before.rows.end()) {
        against.only_now.push_back(name);
        continue;
      }
      is_met[static_cast<std::size_t>(found - before.rows.begin())] = true;
      against.rows.push_back({name, times_ratio(found->samples_s, samples_of(row.timing, basis))});
    }
  }
  for (std::size_t i = 0; i < before.rows.size(); ++i) {
    if (!is_met[i]) against.only_before.push_back(before.rows[i].name);
  }
  return against;
}

std::vector<std::string> other_devices(const EarlierBench& before, const std::vector<Measured>& now) {
  std::vector<std::string> lines;
  for (const Measured& measured : now) {
    const EarlierDevice here{measured.name, measured.device.name,
                             measured.isa ? std::string(to_string(*measured.isa)) : ""};
    for (const EarlierDevice& device : before.devices) {
      if (device.on != here.on || (device.name == here.name && device.isa == here.isa)) continue;
      lines.push_back(fmt::format("{} was {} in {} and is {} now", here.on, words_of(device), printable(before.file),
                                  words_of(here)));
    }
  }
  return lines;
}

std::string against_text(const Against& against) {
  std::size_t width = 0;
  for (const ComparedRow& row : against.rows) width = std::max(width, words_of(row.name).size());
  std::string text = fmt::format("\n{:<{}}  times as fast as in {}, gdtslam {}\n", "", width, printable(against.file),
                                 printable(against.version));
  for (const auto& [name, times] : against.rows) {
    text += fmt::format("{:<{}}  {:6.3f} ({:.3f} to {:.3f})\n", words_of(name), width, times.middle, times.least,
                        times.most);
  }
  for (const RowName& name : against.only_before) text += "only in that run: " + words_of(name) + "\n";
  for (const RowName& name : against.only_now) text += "only in this run: " + words_of(name) + "\n";
  double least = 1.0;
  for (const ComparedRow& row : against.rows) least = std::min(least, row.times.confidence);
  text += fmt::format(
      "Median of the quotients of all pairs of samples, with the interval of Mann and Whitney's test, {:.0f} % or "
      "more. It "
      "is about the\nsamples of these two runs: what the machine did meanwhile is seen in the rows 'limit'.\n",
      std::floor(100.0 * least));
  return text;
}

Json against_json(const Against& against) {
  Json rows = Json::array();
  for (const auto& [name, times] : against.rows) {
    Json row = name_json(name);
    row["times_as_fast"] = times.middle;
    row["least"] = times.least;
    row["most"] = times.most;
    row["confidence"] = times.confidence;
    rows.push_back(std::move(row));
  }
  return {{"file", against.file},
          {"version", against.version},
          {"rows", std::move(rows)},
          {"only_before", names_json(against.only_before)},
          {"only_now", names_json(against.only_now)}};
}

void require_at_least(const Against& against, double least) {
  if (!(least > 0.0)) return;
  std::string slow;
  std::size_t count = 0;
  std::size_t asked = 0;
  for (const ComparedRow& row : against.rows) {
    if (row.name.group == "limit" || row.name.group == "peer") continue;
    ++asked;
    if (row.times.most >= least) continue;
    slow += fmt::format("{} {} ({:.3f})", count == 0 ? "" : ",", words_of(row.name), row.times.middle);
    ++count;
  }
  if (asked == 0) {
    throw Error(
        ExitCode::kFailed,
        fmt::format("--fail-below: {} has no row of this run but limits and peers, so nothing was compared; measure "
                    "what that run did",
                    printable(against.file)));
  }
  if (count == 0) return;
  throw Error(ExitCode::kFailed, fmt::format("{} of {} rows are less than {:g} times as fast as in {}:{}", count, asked,
                                             least, printable(against.file), slow));
}

}  // namespace gdtslam
