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
  const auto count = [](std::size_t number) { return grouped(static_cast<double>(number)); };
  std::string text = fact("maps", count(summary.mapped));
  for (const auto& [name, number] :
       {std::pair{"refused", summary.refused}, {"failed", summary.failed}, {"missing", summary.missing}}) {
    if (number > 0) text += fact(name, count(number), true);
  }
  return text + fact("path", length_of(summary.path_m)) + fact("time in the logs", time_of(summary.log_duration_s)) +
         fact("scans", grouped(static_cast<double>(summary.scans))) + fact("CPU time", time_of(summary.cpu_s)) +
         fact("machines", count(summary.hosts));
}

// The folder that all logs lie in says nothing about one of them.
std::size_t common_folder(const std::vector<FleetRecord>& records) {
  std::string_view common = records.front().log;
  for (const FleetRecord& record : records) {
    const auto [end, other] = std::mismatch(common.begin(), common.end(), record.log.begin(), record.log.end());
    common = common.substr(0, static_cast<std::size_t>(end - common.begin()));
  }
  return common.find_last_of('/') + 1;
}

std::string data_of(const std::string& atlas, const std::vector<FleetRecord>& records) {
  const auto if_there = [&atlas](const std::string& file) {
    std::error_code ignored;
    return fs::exists(atlas + "/" + file, ignored) ? file : std::string();
  };
  Json rows = Json::array();
  for (const FleetRecord& r : records) {
    if (!r.is_mapped()) continue;
    const std::string log = r.log.substr(common_folder(records));
    const std::size_t name = log.find_last_of('/') + 1;
    const std::string picture = fmt::format("logs/{}/{}", name_in_atlas(r.log), kThumbnailName);
    rows.push_back({log.substr(name), log.substr(0, name), r.run, if_there(picture), if_there(r.run + "/overview.png"),
                    r.scans, r.doubtful, r.path_m, r.log_duration_s, r.width_m, r.height_m, r.cpu_s});
  }
  std::string text = rows.dump(-1, ' ', true);
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) text.replace(at, 1, "\\u003c");
  return text;
}

std::string unmapped_table(const std::vector<FleetRecord>& records) {
  constexpr std::size_t kMostShown = 1000;
  std::string rows;
  std::size_t count = 0;
  for (const FleetRecord& record : records) {
    if (record.is_mapped() || ++count > kMostShown) continue;
    rows += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td class=\"code\">{}</td></tr>\n",
                        markup_text(record.log), record.outcome, markup_text(record.reason), record.exit_code);
  }
  if (count == 0) return {};
  if (count > kMostShown)
    rows += fmt::format("<tr><td colspan=\"4\">and {} more, in summary.csv</td></tr>\n", count - kMostShown);
  return fmt::format(
      "<section id=\"unmapped\">\n<h2>Not mapped <span class=\"quiet\">{}</span></h2>\n<div class=\"table\"><table>\n"
      "<thead><tr><th>log</th><th>outcome</th><th>why</th><th>exit</th></tr></thead>\n<tbody>\n{}</tbody></table></div>"
      "\n</section>\n",
      count, rows);
}

// Names and reasons are anybody's: only the page's own script runs, and pictures come from beside the page, whether it
// lies on a disk or on a server.
std::string policy() {
  return fmt::format(
      "default-src 'none'; img-src 'self' file:; style-src {}; script-src {}; base-uri 'none'; form-action 'none'",
      fleet_page::style_hash(), fleet_page::program_hash());
}

}  // namespace

std::string atlas_page(const std::string& atlas, const std::vector<FleetRecord>& records, const AtlasSummary& summary) {
  return filled(fleet_page::skeleton(),
                {{"policy", policy()},
                 {"title", markup_text("Atlas " + fs::canonical(atlas).filename().string())},
                 {"hash", summary.sha256.empty() ? "logs failed or are missing, so there is no hash" : summary.sha256},
                 {"style", std::string(fleet_page::style())},
                 {"facts", facts_of(summary)},
                 {"unmapped", unmapped_table(records)},
                 {"script", std::string(fleet_page::program())},
                 {"data", data_of(atlas, records)}});
}

}  // namespace gdtslam
