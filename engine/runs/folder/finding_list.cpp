#include "finding_list.hpp"

namespace gdtslam {

nlohmann::ordered_json findings_json(const std::vector<LogFinding>& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const LogFinding& finding : findings) {
    list.push_back({{"what", finding.what},
                    {"evidence", finding.evidence},
                    {"options", finding.options},
                    {"mended", finding.is_mended}});
  }
  return list;
}

std::vector<LogFinding> findings_from(const ReportReader& object) {
  std::vector<LogFinding> findings;
  if (!object.has("findings")) return findings;
  for (const ReportReader& entry : object.entries("findings")) {
    findings.push_back({entry.text("what"), entry.text("evidence"), entry.text("options"), entry.truth("mended")});
  }
  return findings;
}

}  // namespace gdtslam
