#include <fmt/format.h>

#include <string_view>

#include "man_pages.hpp"
#include "tools/gdtslam/shell/help/option_rows.hpp"

namespace gdtslam {
namespace {

std::string_view part_of_path(std::string_view path) { return path.substr(0, path.find('.')); }

}  // namespace

ManPage options_page(const PageStamp& stamp) {
  RoffPage page("gdtslam-options", 5, stamp, "options of a run: configuration file and --set");
  page.section("Description");
  page.paragraph(
      plain("Every option that a configuration file of ") + bold("gdtslam") + plain(" (") + bold("-c") + " " +
      italic("FILE") + plain(", YAML) or ") + bold("--set") + " " + italic("PATH=VALUE") +
      plain(" can set. Values carry units: 5 cm, 2 deg, 250 ms, 30 %. With --set a length, an angle or a time "
            "needs its unit unless it is 0; in a file a bare number is in metres, radians or seconds."));
  page.code({"version: 1", "map:", "  resolution: 5 cm", "keyframe:", "  angle: 10 deg"});
  page.paragraph(bold("gdtslam config show") + plain(" prints the values in effect and where each comes from, ") +
                 bold("gdtslam config show --yaml") + plain(" a file to begin with, ") + bold("gdtslam config schema") +
                 plain(" a JSON schema for editors."));
  page.section("Options");
  std::string_view part;
  Settings settings;
  const std::vector<OptionRow> rows = option_rows(settings, "");
  for (const OptionRow& row : rows) {
    if (part_of_path(row.path) != part) {
      part = part_of_path(row.path);
      page.subsection(part);
    }
    page.item(bold(row.path), plain(fmt::format("{}. (default: {}; {})", row.doc, row.default_value, row.allowed)));
  }
  page.section("See also");
  page.paragraph(bold("gdtslam-config") + "(1), " + bold("gdtslam-map") + "(1)");
  return {"gdtslam-options", 5, page.text()};
}

}  // namespace gdtslam
