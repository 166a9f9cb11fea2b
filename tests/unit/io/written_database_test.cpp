// What a ROS 2 bag in SQLite holds, asked of SQLite itself, and what its metadata.yaml says (rosbag2, version 5).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "engine/io/writers/ros2_database.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// The rows of a query, columns between bars.
std::vector<std::string> asked(const std::string& file, const std::string& query) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  std::vector<std::string> rows;
  const auto take = [](void* list, int columns, char** values, char** /*names*/) {
    std::string row;
    for (int k = 0; k < columns; ++k) row += (k == 0 ? "" : "|") + std::string(values[k] == nullptr ? "" : values[k]);
    static_cast<std::vector<std::string>*>(list)->push_back(row);
    return 0;
  };
  EXPECT_EQ(sqlite3_exec(database, query.c_str(), take, &rows, nullptr), SQLITE_OK) << query;
  sqlite3_close_v2(database);
  return rows;
}

constexpr std::int64_t kSecondNs = 1'000'000'000;

/// Three messages, the second the newest, the third the oldest.
void write_database(const std::string& path, bool has_folder) {
  AtomicFileSet files;
  Ros2DatabaseWriter writer(path, files, has_folder);
  EXPECT_EQ(writer.add_channel("/a", RosType::kInt32, false), 1U);
  EXPECT_EQ(writer.add_channel("/b", RosType::kTransforms, true), 2U);
  writer.add(1, 5 * kSecondNs, "one");
  writer.add(2, 9 * kSecondNs + 1, std::string("t\0o", 3));
  writer.add(1, 3 * kSecondNs, "");
  EXPECT_EQ(writer.bytes(), 6U);
  writer.finish();
  files.commit();
}

TEST(WrittenDatabase, HasTopicsAndMessagesInTheirOrder) {
  const TemporaryFolder folder;
  const std::string file = folder / "a.db3";
  write_database(file, false);
  EXPECT_THAT(folder.names(), ElementsAre("a.db3")) << "no journal, no description";
  EXPECT_THAT(asked(file, "SELECT id,name,type,serialization_format FROM topics ORDER BY id"),
              ElementsAre("1|/a|std_msgs/msg/Int32|cdr", "2|/b|tf2_msgs/msg/TFMessage|cdr"));
  EXPECT_THAT(asked(file, "SELECT offered_qos_profiles FROM topics ORDER BY id"),
              ElementsAre(ros2_service_quality(false), ros2_service_quality(true)));
  EXPECT_THAT(asked(file, "SELECT id,topic_id,timestamp,hex(data),typeof(data) FROM messages ORDER BY id"),
              ElementsAre("1|1|5000000000|6F6E65|blob", "2|2|9000000001|74006F|blob", "3|1|3000000000||blob"));
  EXPECT_THAT(asked(file, "SELECT name FROM sqlite_master WHERE type='index' AND tbl_name='messages'"),
              ElementsAre("timestamp_idx"));
  EXPECT_THAT(asked(file, "SELECT schema_version FROM schema"), ElementsAre("3"));
  EXPECT_THAT(asked(file, "PRAGMA integrity_check"), ElementsAre("ok"));
}

TEST(WrittenDatabase, AFolderIsDescribed) {
  const TemporaryFolder folder;
  write_database(folder / "drive//", true);
  const std::string file = folder / "drive/drive_0.db3";
  EXPECT_EQ(asked(file, "SELECT count(*) FROM messages").at(0), "3");
  const YAML::Node bag = YAML::LoadFile(folder / "drive/metadata.yaml")["rosbag2_bagfile_information"];
  EXPECT_EQ(bag["version"].as<int>(), 5);
  EXPECT_EQ(bag["storage_identifier"].as<std::string>(), "sqlite3");
  EXPECT_EQ(bag["relative_file_paths"].size(), 1U);
  EXPECT_EQ(bag["relative_file_paths"][0].as<std::string>(), "drive_0.db3");
  EXPECT_EQ(bag["files"].size(), 1U);
  EXPECT_EQ(bag["files"][0]["path"].as<std::string>(), "drive_0.db3");
  EXPECT_EQ(bag["compression_format"].as<std::string>(), "");
  for (const YAML::Node& about : {bag, bag["files"][0]}) {
    EXPECT_EQ(about["duration"]["nanoseconds"].as<std::int64_t>(), 6 * kSecondNs + 1);
    EXPECT_EQ(about["starting_time"]["nanoseconds_since_epoch"].as<std::int64_t>(), 3 * kSecondNs);
    EXPECT_EQ(about["message_count"].as<int>(), 3);
  }
  const YAML::Node topics = bag["topics_with_message_count"];
  ASSERT_EQ(topics.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const YAML::Node& topic = topics[k]["topic_metadata"];
    EXPECT_EQ(topic["name"].as<std::string>(), k == 0 ? "/a" : "/b");
    EXPECT_EQ(topic["type"].as<std::string>(), k == 0 ? "std_msgs/msg/Int32" : "tf2_msgs/msg/TFMessage");
    EXPECT_EQ(topic["serialization_format"].as<std::string>(), "cdr");
    EXPECT_EQ(topic["offered_qos_profiles"].as<std::string>(), ros2_service_quality(k == 1));
    EXPECT_EQ(topics[k]["message_count"].as<int>(), k == 0 ? 2 : 1);
  }
}

TEST(WrittenDatabase, NamesInQuotesReadBackAsTheyAre) {
  const TemporaryFolder folder;
  const std::string name = "a \"b\" \\n";
  write_database(folder / name + "/", true);
  const YAML::Node bag = YAML::LoadFile(folder / name + "/metadata.yaml")["rosbag2_bagfile_information"];
  EXPECT_EQ(bag["relative_file_paths"][0].as<std::string>(), name + "_0.db3");
}

TEST(WrittenDatabase, WhatIsNotFinishedLeavesNothing) {
  const TemporaryFolder folder;
  {
    AtomicFileSet files;
    Ros2DatabaseWriter writer(folder / "a.db3", files, false);
    writer.add(writer.add_channel("/a", RosType::kInt32, false), 1, "one");
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

}  // namespace
}  // namespace gdtslam
