#include "page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "engine/drawing/letters.hpp"
#include "engine/drawing/page/page_writer.hpp"
#include "engine/runs/fleet/fleet_work.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using page::Json;

/// Length of the folder that all logs lie in, which says nothing about one of them.
std::size_t common_folder(const std::vector<FleetRecord>& records) {
  std::string_view common = records.front().log;
  for (const FleetRecord& record : records) {
    const auto [end, other] = std::mismatch(common.begin(), common.end(), record.log.begin(), record.log.end());
    common = common.substr(0, static_cast<std::size_t>(end - common.begin()));
  }
  return common.find_last_of('/') + 1;
}

Json row_of(const std::string& atlas, const FleetRecord& record, const std::string& log) {
  const auto if_there = [&atlas](const std::string& file) {
    std::error_code ignored;
    return fs::exists(atlas + "/" + file, ignored) ? file : std::string();
  };
  const std::size_t name = log.find_last_of('/') + 1;
  return {{"name", legible(log.substr(name))},
          {"folder", legible(log.substr(0, name))},
          {"run", record.run},
          {"picture", if_there(fmt::format("logs/{}/{}", name_in_atlas(record.log), kThumbnailName))},
          {"overview", if_there(record.run + "/overview.png")},
          {"scans", record.scans},
          {"doubtful", record.doubtful},
          {"path_m", record.path_m},
          {"log_duration_s", record.log_duration_s},
          {"width_m", record.width_m},
          {"height_m", record.height_m},
          {"cpu_s", record.cpu_s}};
}

}  // namespace

std::string atlas_page(const std::string& atlas, const std::vector<FleetRecord>& records, const AtlasSummary& summary) {
  Json rows = Json::array();
  Json unmapped = Json::array();
  for (const FleetRecord& record : records) {
    if (record.is_mapped()) {
      rows.push_back(row_of(atlas, record, record.log.substr(common_folder(records))));
    } else {
      unmapped.push_back({legible(record.log), record.outcome, legible(record.reason), record.exit_code});
    }
  }
  page::PageData data;
  data.description = {
      {"title", legible("Atlas " + fs::canonical(atlas).filename().string())},
      {"subtitle", summary.sha256.empty() ? "logs failed or are missing, so there is no hash" : summary.sha256},
      {"atlas", {{"rows", rows}, {"unmapped", unmapped}, {"hosts", summary.hosts}}}};
  // Pictures come from beside the page, on a disk as on a server.
  return page::page_text(data, "img-src 'self' file: data:");
}

}  // namespace gdtslam
