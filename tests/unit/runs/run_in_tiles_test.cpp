// A run whose map is in tiles: what can be read and cut out of it, and the tiles of an edit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/sha256.hpp"
#include "engine/runs/edits/edit_run.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/map_files.hpp"
#include "ring_run.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using test::ring_run;
using testing::HasSubstr;

// A wall where any of the cells is one, four along each side.
OccupancyMap overview_of(const OccupancyMap& map) {
  constexpr std::int32_t kScale = 4;
  OccupancyMap coarse;
  coarse.geometry = map.geometry;
  coarse.geometry.resolution_m *= kScale;
  coarse.geometry.width = (map.geometry.width + kScale - 1) / kScale;
  coarse.geometry.height = (map.geometry.height + kScale - 1) / kScale;
  std::vector<CellState> states(coarse.geometry.cell_count());
  for (std::int32_t y = 0; y < map.geometry.height; ++y) {
    for (std::int32_t x = 0; x < map.geometry.width; ++x) {
      CellState& state = states[static_cast<std::size_t>(y / kScale * coarse.geometry.width + x / kScale)];
      state = std::max(state, map.at({x, y}));
    }
  }
  coarse.cells = CellStates(states);
  return coarse;
}

// Around the ring with a laser that sees a passage and no farther.
void map_near_sighted(const std::string& folder) {
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  MapRequest request = test::ring_request(ring_run().log, folder);
  request.settings.mapper.scan.max_range_m = 9.0;
  static_cast<void>(map_logs(request, *cpu));
}

// The run as if it had been too large for one piece.
std::string run_in_tiles(const std::string& whole, const test::RunsFolder& folder) {
  std::string run = folder.path("run");
  fs::copy(whole, run, fs::copy_options::recursive);
  const OccupancyMap overview = overview_of(RunReader(run).map());
  write_occupancy_map(run + "/map.yaml", overview);
  ordered_json report = ordered_json::parse(test::text_of_file(run + "/report.json"));
  report["tiles"] = 4;
  report["map"] = geometry_json(overview.geometry);
  ordered_json files = ordered_json::array();
  for (const ordered_json& row : report.at("files")) {
    const auto name = row[0].get<std::string>();
    if (name.starts_with("gdt.")) {
      fs::remove(run + "/" + name);
    } else if (name.starts_with("map.")) {
      const std::string bytes = test::text_of_file(run + "/" + name);
      files.push_back({name, bytes.size(), Sha256().update(bytes).hex()});
    } else {
      files.push_back(row);
    }
  }
  report["files"] = std::move(files);
  std::ofstream(run + "/report.json") << report.dump();
  return run;
}

EditRequest crop_of(const std::string& run, const std::string& folder) {
  EditRequest request;
  request.run = run;
  request.folder = folder;
  request.crop = RegionBounds{{-2.0, -3.0}, {6.0, 1.0}};
  request.with_pictures = false;
  return request;
}

template <class Call>
std::string fault_in_tiles(const Call& call) {
  try {
    static_cast<void>(call());
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(RunInTiles, GivesPiecesWithAllTheirCells) {
  const test::RunsFolder folder("pieces");
  map_near_sighted(folder.path("whole"));
  const std::string run = run_in_tiles(folder.path("whole"), folder);
  EXPECT_EQ(RunReader(run).summary().tiles, 4U);
  const EditOutcome piece = edit_run(crop_of(run, folder.path("piece")));
  EXPECT_GT(piece.scans, 0U) << "it is cast anew";
  EXPECT_LT(piece.scans, ring_run().truth.size()) << "from scans that may reach it";
  EXPECT_EQ(edit_run(crop_of(folder.path("whole"), folder.path("crop"))).scans, 0U);
  for (const char* name : {"map.pgm", "map.yaml", "gdt.png", "keyframes.bin.gz"}) {
    EXPECT_EQ(test::text_of_file(folder.path("piece/") + name), test::text_of_file(folder.path("crop/") + name))
        << name;
  }
  const ordered_json report = ordered_json::parse(test::text_of_file(folder.path("piece/report.json")));
  EXPECT_FALSE(report.contains("tiles")) << "it is in one piece";
  EXPECT_EQ(RunReader(folder.path("piece")).map().geometry.resolution_m, 0.025);
  EditRequest nowhere = crop_of(run, folder.path("nothing"));
  nowhere.crop = RegionBounds{{500.0, 500.0}, {501.0, 501.0}};
  EXPECT_THAT(fault_in_tiles([&] { return edit_run(nowhere); }), HasSubstr("--crop leaves nothing of the map"));
}

TEST(RunInTiles, SaysSoWhereItsDistanceFieldIsWanted) {
  const test::RunsFolder folder("tiles-field");
  const std::string run = run_in_tiles(ring_run().folder, folder);
  const std::string fault = fault_in_tiles([&] { return RunReader(run).field(); });
  EXPECT_THAT(fault, HasSubstr("in tiles"));
  EXPECT_THAT(fault, HasSubstr("gdtslam edit RUN --crop X0,Y0,X1,Y1 -o PART"));
}

// Tiles of an edit are those of the keyframes, all or none.
TEST(RunInTiles, AnEditWritesThem) {
  const test::RunsFolder folder("edit-tiles");
  EditRequest request;
  request.run = ring_run().folder;
  request.folder = folder.path("tiled");
  request.with_tiles = true;
  request.with_pictures = false;
  // The corridor reaches over the origin both ways, and a tile has 51.2 m: four of them.
  EXPECT_EQ(edit_run(request).tiles, 4U);
  const ordered_json index = ordered_json::parse(test::text_of_file(request.folder + "/tiles/index.json"));
  EXPECT_EQ(index.at("tiles").size(), 4U);
  EXPECT_EQ(index.at("tiles")[0].at("x"), -1) << "by rows";
  EXPECT_EQ(index.at("keyframes_sha256"), *RunReader(request.folder).summary().keyframes_sha256);
  for (const char* name : {"map.pgm", "keyframes.bin.gz"}) {
    EXPECT_EQ(test::text_of_file(folder.path("tiled/") + name), test::text_of_file(ring_run().folder + "/" + name))
        << name;
  }
  request.run = request.folder;
  request.folder = folder.path("again");
  double share_of_tiles = 0.0;
  request.progress = [&](std::string_view step, double share) {
    if (step == "the tiles") share_of_tiles = share;
  };
  request.stop = [&] { return share_of_tiles > 0.0; };  // once a tile is made
  EXPECT_THAT(fault_in_tiles([&] { return edit_run(request); }), HasSubstr("interrupted; nothing was written"));
  EXPECT_FALSE(fs::exists(request.folder));
}

}  // namespace
}  // namespace gdtslam
