#include "summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "atlas_hash.hpp"
#include "engine/io/sha256.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kSlowestShown = 10;

void count(const std::optional<UnitRecord>& record, AtlasCounts& counts) {
  ++counts.units;
  if (record) ++(record->is_mapped() ? counts.mapped : counts.refused);
}

Json counts_json(const AtlasCounts& counts) {
  return {
      {"units", counts.units}, {"mapped", counts.mapped}, {"refused", counts.refused}, {"missing", counts.missing()}};
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string whole = "\"";
  for (const char c : text) whole += c == '"' ? std::string("\"\"") : std::string(1, c);
  return whole + "\"";
}

}  // namespace

std::string kind_of_reason(std::string_view reason) {
  std::string kind;
  for (std::size_t k = 0; k < reason.size(); ++k) {
    const auto is_digit = [&reason](std::size_t at) {
      return at < reason.size() && reason[at] >= '0' && reason[at] <= '9';
    };
    if (!is_digit(k)) {
      kind += reason[k];
      continue;
    }
    while (is_digit(k + 1) || (k + 1 < reason.size() && reason[k + 1] == '.' && is_digit(k + 2))) ++k;
    kind += 'N';
  }
  return kind;
}

AtlasSummary summary_of(const StoredPlan& stored, const AtlasState& state) {
  AtlasSummary summary;
  for (const std::optional<UnitRecord>& record : state.records) {
    count(record, summary.counts);
    if (!record) continue;
    summary.scans += record->figures.scans;
    summary.path_m += record->figures.path_m;
    summary.log_duration_s += record->figures.log_duration_s;
    summary.cpu_s += record->cpu_s;
    summary.wall_s += record->wall_s;
    ++summary.hosts[record->host];
    if (!record->is_mapped()) ++summary.reasons[kind_of_reason(record->reason)];
    summary.slowest.push_back(record->unit);
  }
  for (const auto& shard : stored.plan.shards) {
    AtlasCounts counts;
    for (const std::uint32_t unit : shard) count(state.records[unit], counts);
    summary.shards.push_back(counts);
  }
  const auto middle =
      summary.slowest.begin() + static_cast<std::ptrdiff_t>(std::min(kSlowestShown, summary.slowest.size()));
  std::partial_sort(summary.slowest.begin(), middle, summary.slowest.end(), [&state](std::size_t a, std::size_t b) {
    const double a_s = state.records[a]->cpu_s;
    const double b_s = state.records[b]->cpu_s;
    return a_s != b_s ? a_s > b_s : a < b;
  });
  summary.slowest.erase(middle, summary.slowest.end());
  return summary;
}

Json status_json(const StoredPlan& stored, const AtlasState& state, const AtlasSummary& summary) {
  Json json = {{"format", kAtlasFormat}, {"plan", stored.id}};
  json.update(counts_json(summary.counts));
  json["cpu_s"] = summary.cpu_s;
  json["reasons"] = summary.reasons;
  json["slowest"] = Json::array();
  for (const std::size_t unit : summary.slowest)
    json["slowest"].push_back(
        {{"unit", unit}, {"uri", stored.plan.units[unit].uri}, {"cpu_s", state.records[unit]->cpu_s}});
  json["hosts"] = summary.hosts;
  json["shards"] = Json::array();
  for (const AtlasCounts& shard : summary.shards) json["shards"].push_back(counts_json(shard));
  json["damaged"] = state.damaged;
  json["lost"] = state.lost.size();
  return json;
}

Json atlas_json(const StoredPlan& stored, const AtlasState& state, const AtlasSummary& summary) {
  Json json = {{"format", kAtlasFormat},
               {"version", stored.plan.program.version},
               {"plan", stored.id},
               {"config_sha256", Sha256().update(stored.plan.config).hex()}};
  json.update(counts_json(summary.counts));
  json["atlas_sha256"] = summary.counts.missing() == 0 ? Json(atlas_sha256_of(state)) : Json(nullptr);
  json["scans"] = summary.scans;
  json["path_m"] = summary.path_m;
  json["log_duration_s"] = summary.log_duration_s;
  json["cpu_s"] = summary.cpu_s;
  json["reasons"] = summary.reasons;
  json["hosts"] = summary.hosts;
  return json;
}

std::string summary_csv(const StoredPlan& stored, const AtlasState& state) {
  std::string text =
      "unit,uri,outcome,exit_code,reason,run,bytes,scans,doubtful,keyframes,path_m,log_duration_s,width_m,height_m,cpu_"
      "s,"
      "wall_s,host,isa,device,input_sha256,result_sha256\n";
  for (std::size_t k = 0; k < state.records.size(); ++k) {
    const std::string uri = quoted(stored.plan.units[k].uri);
    if (!state.records[k]) {
      text += fmt::format("{},{},missing,,,,,,,,,,,,,,,,,,\n", k, uri);
      continue;
    }
    const UnitRecord& r = *state.records[k];
    const UnitFigures& f = r.figures;
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", k, uri,
                        r.is_mapped() ? "mapped" : "refused", r.exit_code, quoted(r.reason), r.run, r.bytes, f.scans,
                        f.doubtful, f.keyframes, f.path_m, f.log_duration_s, f.width_m, f.height_m, r.cpu_s, r.wall_s,
                        r.host, r.isa, quoted(r.device), r.input_sha256, r.result_sha256);
  }
  return text;
}

}  // namespace gdtslam
