// gdtslam tiles: the map of a run in tiles.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <charconv>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/retiling/make_tiles.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

struct TilesCommand {
  std::string run;
  std::vector<std::string> only;
  bool quiet = false;
};

std::optional<std::int32_t> whole_number(std::string_view text) {
  std::int32_t value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

CellIndex parse_place(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma != std::string::npos) {
    const std::optional<std::int32_t> x = whole_number(std::string_view(text).substr(0, comma));
    const std::optional<std::int32_t> y = whole_number(std::string_view(text).substr(comma + 1));
    if (x && y) return {*x, *y};
  }
  throw UsageError(fmt::format("--only: '{}' is no tile: give its column and row, as 3,-1", text));
}

int make(const TilesCommand& command) {
  TerminalLine line(command.quiet);
  TilesRequest request{.run = command.run, .only = {}, .progress = {}, .stop = [] { return interrupted(); }};
  for (const std::string& text : command.only) request.only.push_back(parse_place(text));
  request.progress = [&line](double share) {
    line.draw([&](double) { return fmt::format("{:4.0f} %  tiles", 100.0 * share); });
  };
  const TilesOutcome outcome = make_tiles(request);
  line.clear();
  if (command.quiet) return static_cast<int>(ExitCode::kDone);
  const double side_m = kMapTileSide * outcome.index.resolution_m;
  std::string text =
      fmt::format("{}: {} {} of {:g} m, each with gdt_X_Y.yaml{}\n", printable(outcome.folder), outcome.made,
                  outcome.made == 1 ? "tile" : "tiles", side_m, outcome.index.has_occupancy ? " and map_X_Y.yaml" : "");
  for (const CellIndex& tile : outcome.changed)
    text += fmt::format("tile {},{} is another than before\n", tile.x, tile.y);
  print_result(text);
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_tiles_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<TilesCommand>();
  CLI::App* command = add_command(app, "tiles", "Keep the map of a run in tiles of 2048 cells a side");
  command->add_option("run", options->run, "Folder of a run of 'gdtslam map' or 'merge'")->required()->type_name("RUN");
  command
      ->add_option("--only", options->only,
                   "Make this tile again, by its column and row; may be repeated. The others stay as they are")
      ->type_name("X,Y");
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "A map that would have more than 2^29 cells, 580 m x 580 m of 25 mm, is written in tiles by 'gdtslam map' "
      "itself;\n"
      "this makes those of any run of a flat laser, from its keyframes alone. The folder RUN/tiles has for each tile "
      "its\n"
      "part of the distance field (gdt_X_Y.yaml) and of the occupancy map (map_X_Y.yaml), which are maps in "
      "themselves,\n"
      "and index.json, which names them. A tile is made from the keyframes that touch it and from nothing else: made\n"
      "again alone it has the same cells.\n"
      "\n"
      "Examples:\n"
      "  gdtslam tiles out\n"
      "  gdtslam tiles out --only 0,0 --only 3,-1\n"
      "  gdtslam localize out/tiles/map_0_0.yaml log.gz --scan 12");
  command->callback([options, &context] {
    context.run = [options] { return make(*options); };
    context.when_out_of_memory = kSmallerMap;
  });
}

}  // namespace gdtslam
