// What lies in an atlas and is none of its files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "engine/runs/fleet/state.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

UnitRecord record_of_unit(std::size_t unit) {
  UnitRecord record;
  record.plan = std::string(16, 'a');
  record.unit = unit;
  record.input_sha256 = std::string(64, 'a');
  record.run = std::string(16, '9');
  record.result_sha256 = std::string(64, 'f');
  return record;
}

class FleetStrays : public testing::Test {
 protected:
  FleetStrays() {
    stored_.id = std::string(16, 'a');
    stored_.plan.units = {{"/a", 1}, {"/b", 1}, {"/c", 1}};
    stored_.plan.shards = {{0, 1, 2}};
    write_record(atlas(), record_of_unit(0));
  }
  [[nodiscard]] std::string atlas() const { return folder_.path(); }
  [[nodiscard]] std::string path(const std::string& name) const { return atlas() + "/" + name; }
  void put(const std::string& name) const {
    fs::create_directories(fs::path(path(name)).parent_path());
    std::ofstream(path(name)) << "x";
  }
  [[nodiscard]] AtlasState state() const { return read_state(atlas(), stored_); }

  const TemporaryFolder folder_{"gdtslam-fleet-test"};
  StoredPlan stored_;
};

TEST_F(FleetStrays, OfOtherNamesAreNobodys) {
  for (const char* name :
       {"units/.DS_Store", "units/notes.txt", "units/000/.DS_Store", "units/000/1.json", "units/000/000001 2.json",
        "units/000/000001.json~", "units/000/0000001.json", "units/001/000001.json", "units/old/000002.json",
        "units/0000/000002.json", "shards/.DS_Store", "shards/mine.tsv"})
    put(name);
  fs::create_directory(path("shards/folder.tsv"));
  EXPECT_THAT(units_with_record(atlas(), 3), ElementsAre(true, false, false));
  const AtlasState found = state();
  EXPECT_TRUE(found.records[0]);
  EXPECT_THAT(found.damaged, IsEmpty());
}

TEST_F(FleetStrays, InThePlaceOfARecordAreNamed) {
  fs::create_symlink("nowhere", path("units/000/000000.json.new"));
  fs::rename(path("units/000/000000.json.new"), path("units/000/000000.json"));
  fs::create_directory(path("units/000/000001.json"));
  ASSERT_EQ(::mkfifo(path("units/000/000002.json").c_str(), 0600), 0);
  const AtlasState found = state();
  for (const auto& record : found.records) EXPECT_FALSE(record);
  const auto is_named = HasSubstr(".json: is no plain file; remove it and run its shard again");
  EXPECT_THAT(found.damaged, ElementsAre(is_named, is_named, is_named));
  for (std::size_t unit = 0; unit < 3; ++unit) EXPECT_THROW(write_record(atlas(), record_of_unit(unit)), FileError);
  EXPECT_FALSE(fs::exists(path("units/000/nowhere"))) << "it was written through the link";
  fs::remove(path("units/000/000002.json"));
  write_record(atlas(), record_of_unit(2));
  EXPECT_TRUE(state().records[2]);
}

TEST_F(FleetStrays, ALinkThatLeadsNowhereIsNoEmptyFolder) {
  fs::remove_all(path("units"));
  fs::create_symlink("nowhere", path("units"));
  try {
    (void)state();
    FAIL() << "as if nothing were done";
  } catch (const FileError& error) {
    EXPECT_EQ(error.what(), path("units") + ": is a link that leads nowhere; remove it");
  }
}

TEST_F(FleetStrays, InThePlaceOfATableAreNoneAndNamed) {
  fs::create_directory(path("shards"));
  ASSERT_EQ(::mkfifo(path("shards/0001.tsv").c_str(), 0600), 0);
  const AtlasState found = state();
  EXPECT_TRUE(found.records[0]);
  EXPECT_THROW(write_shard_table(atlas(), stored_, 0, found), FileError);
}

}  // namespace
}  // namespace gdtslam
