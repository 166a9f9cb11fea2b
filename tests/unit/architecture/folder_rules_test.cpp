// The rules about folders: each is shown what breaks it and what does not, then the tree itself.
#include "folder_rules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tree.hpp"

namespace gdtslam::architecture {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(Rooms, know_only_those_below_them) {
  const auto violations = [](std::string_view path, std::string_view header) {
    return room_violations(path, "// What.\n#include \"" + std::string(header) + "\"\n");
  };
  EXPECT_THAT(violations("engine/mapping/match/scan_matcher.cpp", "engine/mapping/cost/objective.hpp"), IsEmpty());
  EXPECT_THAT(violations("engine/mapping/map/growth.cpp", "engine/mapping/match/matchers.hpp"), SizeIs(1));
  EXPECT_THAT(violations("tools/gdtslam/render/run.cpp", "tools/gdtslam/render/files/glb.hpp"), IsEmpty());
  EXPECT_THAT(violations("tools/gdtslam/render/run.cpp", "tools/gdtslam/map/command.hpp"), SizeIs(1));
  EXPECT_THAT(violations("tools/gdtslam/doctor/command.cpp", "tools/gdtslam/render/studio.hpp"), SizeIs(1));
  EXPECT_THAT(violations("tools/gdtslam/shell/console.cpp", "tools/lab/bench/rows.hpp"), SizeIs(1));
  EXPECT_THAT(violations("engine/mapping/unknown/a.cpp", "engine/mapping/map/store/growth.hpp"), SizeIs(1)) << "no row";
}

TEST(Rooms, of_public_headers_are_those_of_their_part) {
  EXPECT_EQ(room_of("engine/core/include/gdtslam/core/pose.hpp"), "engine/core");
  EXPECT_EQ(room_of("engine/mapping/match/descents.cpp"), "engine/mapping/match");
  EXPECT_EQ(room_of("engine/compute/kernels/gdt_merge/gdt_merge.cpp"), "engine/compute/kernels");
  EXPECT_EQ(room_of("README.md"), "");
}

TEST(Circles, are_found) {
  EXPECT_THAT(circle_in({{"a", {"b", "c"}}, {"b", {"c"}}, {"c", {}}}), IsEmpty());
  EXPECT_THAT(circle_in({{"a", {"b"}}, {"b", {"c"}}, {"c", {"a"}}}), ElementsAre("a", "b", "c", "a"));
}

TEST(Tree, arrows_between_rooms_run_down_only) {
  EXPECT_THAT(circle_in(room_arrows()), IsEmpty());
  for (const SourceFile& file : code()) report(file, room_violations(file.path, file.text));
}

TEST(Tree, every_room_of_the_table_is_there) {
  std::set<std::string> rooms;
  for (const SourceFile& file : code()) rooms.insert(room_of(file.path));
  for (const auto& [room, below] : room_arrows()) EXPECT_TRUE(rooms.contains(room)) << room << " holds no source";
}

TEST(Tree, no_folder_has_more_sources_than_a_person_can_overlook) {
  std::map<std::string, std::size_t> sources;
  for (const SourceFile& file : code()) {
    if (file.path.starts_with("tests/")) continue;
    if (file.path.ends_with(".cpp") || file.path.ends_with(".hpp") || file.path.ends_with(".inl")) {
      ++sources[file.path.substr(0, file.path.rfind('/'))];
    }
  }
  for (const auto& [folder, count] : sources) EXPECT_LE(count, kMostSources) << folder;
}

TEST(Tree, libraries_show_few_headers) {
  std::vector<std::string> headers;
  for (const SourceFile& file : code()) {
    if (file.path.find("/include/gdtslam/") != std::string::npos) headers.push_back(file.path);
  }
  EXPECT_LE(headers.size(), kMostPublicHeaders);
}

}  // namespace
}  // namespace gdtslam::architecture
