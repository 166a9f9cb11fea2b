#include "page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "engine/drawing/markup.hpp"
#include "engine/runs/fleet/thumbnail.hpp"

namespace gdtslam::fleet_page {
std::string_view skeleton();
std::string_view style();
std::string_view style_hash();
std::string_view program();
std::string_view program_hash();
}  // namespace gdtslam::fleet_page

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMostRefusedShown = 1000;

// In one pass, so that no text of others is taken for a mark.
std::string filled(std::string_view skeleton, const std::map<std::string, std::string, std::less<>>& values) {
  std::string page;
  for (std::size_t begin = 0; (begin = skeleton.find("{{")) != std::string_view::npos;) {
    const std::size_t end = skeleton.find("}}", begin);
    page += skeleton.substr(0, begin);
    page += values.at(std::string(skeleton.substr(begin + 2, end - begin - 2)));
    skeleton.remove_prefix(end + 2);
  }
  return page += skeleton;
}

std::string fact(const std::string& name, const std::string& value, bool is_warning = false) {
  return fmt::format("<div{}><dt>{}</dt><dd>{}</dd></div>\n", is_warning ? " class=\"warning\"" : "", name,
                     markup_text(value));
}

// 1,234
std::string grouped(double value) {
  std::string digits = fmt::format("{:.0f}", value);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, ",");
  return digits;
}

std::string time_of(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.0f} s", seconds);
  return seconds < 7200.0 ? fmt::format("{:.0f} min", seconds / 60.0) : grouped(seconds / 3600.0) + " h";
}

std::string length_of(double metres) {
  return metres < 10000.0 ? grouped(metres) + " m" : grouped(metres / 1000.0) + " km";
}

std::string facts_of(const AtlasSummary& summary) {
  const AtlasCounts& counts = summary.counts;
  std::string text = fact("maps", grouped(static_cast<double>(counts.mapped)));
  text += fact("refused", grouped(static_cast<double>(counts.refused)), counts.refused > 0);
  if (counts.missing() > 0) text += fact("missing", grouped(static_cast<double>(counts.missing())), true);
  text += fact("path", length_of(summary.path_m)) + fact("time in the logs", time_of(summary.log_duration_s)) +
          fact("scans", grouped(static_cast<double>(summary.scans))) + fact("CPU time", time_of(summary.cpu_s));
  return text + fact(summary.hosts.size() == 1 ? "host" : "hosts",
                     summary.hosts.size() == 1 ? summary.hosts.begin()->first
                                               : grouped(static_cast<double>(summary.hosts.size())));
}

// What all URIs begin with says nothing about one of them.
std::size_t common_folder(const std::vector<FleetUnit>& units) {
  std::string_view common = units.front().uri;
  for (const FleetUnit& unit : units) {
    const auto [end, other] = std::mismatch(common.begin(), common.end(), unit.uri.begin(), unit.uri.end());
    common = common.substr(0, static_cast<std::size_t>(end - common.begin()));
  }
  const std::size_t slash = common.find_last_of('/');
  return slash == std::string_view::npos ? 0 : slash + 1;
}

std::string data_of(const std::string& atlas, const StoredPlan& stored, const AtlasState& state) {
  const std::size_t begin = common_folder(stored.plan.units);
  Json rows = Json::array();
  for (std::size_t k = 0; k < state.records.size(); ++k) {
    if (!state.records[k] || !state.records[k]->is_mapped()) continue;
    const UnitRecord& record = *state.records[k];
    const UnitFigures& f = record.figures;
    const std::string uri = stored.plan.units[k].uri.substr(begin);
    const std::size_t slash = uri.find_last_of('/');
    const std::string run = run_path(record.run);
    std::error_code ignored;
    const bool has_overview = fs::exists(fmt::format("{}/{}/overview.png", atlas, run), ignored);
    rows.push_back({uri.substr(slash == std::string::npos ? 0 : slash + 1),
                    slash == std::string::npos ? "" : uri.substr(0, slash), run, thumbnail_of(atlas, record.run),
                    has_overview ? run + "/overview.png" : "", f.scans, f.doubtful, f.path_m, f.log_duration_s,
                    f.width_m, f.height_m, record.cpu_s});
  }
  std::string text = rows.dump(-1, ' ', true);
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) text.replace(at, 1, "\\u003c");
  return text;
}

std::string refused_of(const StoredPlan& stored, const AtlasState& state) {
  std::string rows;
  std::size_t count = 0;
  for (std::size_t k = 0; k < state.records.size(); ++k) {
    if (!state.records[k] || state.records[k]->is_mapped()) continue;
    if (++count > kMostRefusedShown) continue;
    rows += fmt::format("<tr><td>{}</td><td>{}</td><td class=\"code\">{}</td></tr>\n",
                        markup_text(stored.plan.units[k].uri), markup_text(state.records[k]->reason),
                        state.records[k]->exit_code);
  }
  if (count == 0) return {};
  if (count > kMostRefusedShown)
    rows += fmt::format("<tr><td colspan=\"3\">and {} more, in summary.csv</td></tr>\n", count - kMostRefusedShown);
  return fmt::format(
      "<section id=\"refused\">\n<h2>Refused <span class=\"quiet\">{}</span></h2>\n<div class=\"table\"><table>\n"
      "<thead><tr><th>log</th><th>why</th><th>exit</th></tr></thead>\n<tbody>\n{}</tbody></table></div>\n</section>\n",
      count, rows);
}

// What `fleet merge` left.
std::string site_of(const std::string& atlas) {
  std::error_code ignored;
  if (!fs::exists(atlas + "/site/merge.json", ignored)) return {};
  return "<section>\n<h2>Sites</h2>\n<p><a href=\"site/\">The runs that overlap, joined</a>; <a "
         "href=\"site/merge.json\">"
         "merge.json</a></p>\n</section>\n";
}

// Names and reasons are anybody's: only the page's own script runs, and pictures come from beside the page, whether it
// lies on a disk or on a server.
std::string policy() {
  return fmt::format(
      "default-src 'none'; img-src 'self' file:; style-src {}; script-src {}; base-uri 'none'; form-action 'none'",
      fleet_page::style_hash(), fleet_page::program_hash());
}

}  // namespace

std::string atlas_page(const std::string& atlas, const StoredPlan& stored, const AtlasState& state,
                       const AtlasSummary& summary, const std::string& hash) {
  return filled(fleet_page::skeleton(), {{"policy", policy()},
                                         {"title", markup_text("Atlas " + fs::canonical(atlas).filename().string())},
                                         {"hash", hash.empty() ? "logs are missing, so there is no hash" : hash},
                                         {"style", std::string(fleet_page::style())},
                                         {"facts", facts_of(summary)},
                                         {"site", site_of(atlas)},
                                         {"refused", refused_of(stored, state)},
                                         {"script", std::string(fleet_page::program())},
                                         {"data", data_of(atlas, stored, state)}});
}

}  // namespace gdtslam
