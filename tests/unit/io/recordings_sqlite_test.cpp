// ROS 2 bags in SQLite, written by the shell of SQLite (not our code): schemas of all versions, split and packed files,
// damage.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"
#include "io_test_support.hpp"
#include "mcap_writer.hpp"

namespace gdtslam {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<std::string> kTopicColumns{
    "id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT",
    "id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT",
    "id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT, "
    "type_description_hash TEXT"};

std::string hex(const std::string& bytes) {
  std::string text;
  for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned>(static_cast<unsigned char>(byte)));
  return text;
}

std::string insert(int topic, double received_s, const std::string& data) {
  return fmt::format("INSERT INTO messages(topic_id, timestamp, data) VALUES({}, {}, x'{}');\n", topic,
                     static_cast<std::int64_t>(received_s * 1e9), hex(data));
}

/// The tables of a bag with the topics 3 (/scan), 1 (/odom) and 2 (/tf).
std::string tables(std::size_t version = 1) {
  return "CREATE TABLE topics(" + kTopicColumns[version] +
         ");\nCREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);\n"
         "CREATE INDEX timestamp_idx ON messages (timestamp ASC);\n"
         "INSERT INTO topics(id, name, type, serialization_format) VALUES(3, '/scan', 'sensor_msgs/msg/LaserScan', "
         "'cdr'), (1, '/odom', 'nav_msgs/msg/Odometry', 'cdr'), (2, '/tf', 'tf2_msgs/msg/TFMessage', 'cdr');\n";
}

/// Scans at `first`, `first` + 1, ... between odometry half a second before and behind each.
std::string drive_rows(double first_s, int scans, bool is_packed = false) {
  const auto bytes = [is_packed](const std::string& data) { return is_packed ? packed_as("zstd", data) : data; };
  std::string sql;
  for (int k = 0; k < scans; ++k) {
    const double stamp_s = first_s + k;
    sql += insert(1, stamp_s, bytes(cdr_odometry(stamp_s - 0.5, {.x_m = stamp_s - 0.5})));
    sql += insert(3, stamp_s, bytes(cdr_scan({.stamp_s = stamp_s})));
    sql += insert(1, stamp_s, bytes(cdr_odometry(stamp_s + 0.25, {.x_m = stamp_s + 0.25})));
  }
  return sql;
}

void run_shell(const std::string& command) { ASSERT_EQ(std::system(command.c_str()), 0) << command; }

void make_database(const std::string& file, const std::string& sql, const std::string& first = "") {
  put_file(file + ".sql", first + "BEGIN;\n" + sql + "COMMIT;\n");
  run_shell(fmt::format("sqlite3 '{0}' < '{0}.sql'", file));
  std::filesystem::remove(file + ".sql");
}

template <class Failure>
std::string log_refusal(const std::string& path, const ReadOptions& options = {}) {
  return told_by<Failure>([&] { drain(*open_log(path, options)); }, "no such error");
}

std::vector<double> stamps_of(const WholeLog& log) {
  std::vector<double> stamps_s;
  for (const ScanRecord& record : log.of<ScanRecord>()) {
    stamps_s.push_back(record.scan.stamp_s);
    EXPECT_NEAR(record.T_odom_base.value().x_m, record.scan.stamp_s, 1e-9);
  }
  return stamps_s;
}

TEST(SqliteBags, SchemasOfAllVersionsAreRead) {
  const TemporaryFolder folder;
  for (std::size_t version = 0; version < kTopicColumns.size(); ++version) {
    const std::string file = folder / fmt::format("v{}.db3", version);
    make_database(file, tables(version) + drive_rows(1.0, 3));
    const WholeLog log = drain(*open_log(file, {}));
    EXPECT_THAT(stamps_of(log), ElementsAre(1.0, 2.0, 3.0)) << version;
  }
  EXPECT_THAT(folder.names(), ::testing::UnorderedElementsAre("v0.db3", "v1.db3", "v2.db3")) << "nothing is left";
}

TEST(SqliteBags, FilesOfAFolderFollowEachOther) {
  const TemporaryFolder folder;
  make_database(folder / "bag_10.db3", tables() + drive_rows(5.0, 2));
  make_database(folder / "bag_2.db3", tables() + drive_rows(3.0, 2));
  make_database(folder / "bag_0.db3", tables() + drive_rows(1.0, 2));
  EXPECT_THAT(log_refusal<InputError>(folder.path()), HasSubstr("has 3 files and no metadata.yaml that names them"));
  const std::string head = "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n";
  put_file(folder / "metadata.yaml", head + "  relative_file_paths:\n    - bag/bag_2.db3\n    - bag_10.db3\n");
  EXPECT_THAT(stamps_of(drain(*open_log(folder.path(), {}))), ElementsAre(3.0, 4.0, 5.0, 6.0));
  put_file(folder / "metadata.yaml", head + "  relative_file_paths: [bag_0.db3, bag_1.db3]\n");
  const WholeLog missing = drain(*open_log(folder.path(), {}));
  EXPECT_THAT(stamps_of(missing), ElementsAre(1.0, 2.0));
  EXPECT_EQ(missing.warned("missing file of the bag"), 1U);
  for (const char* unreadable : {"rosbag2_bagfile_information: [\n", "rosbag2_bagfile_information: [a, b]\n"}) {
    put_file(folder / "metadata.yaml", unreadable);
    EXPECT_THAT(log_refusal<InputError>(folder.path()), HasSubstr("metadata.yaml")) << unreadable;
  }
}

// Four bytes of zstd can stand for 128 KiB on the disk.
TEST(SqliteBags, WhatUnpacksToFarMoreIsNotWritten) {
  const TemporaryFolder folder;
  make_database(folder / "a.db3", tables() + drive_rows(1.0, 2));
  const std::string whole = get_file(folder / "a.db3");
  put_file(folder / "a.db3", packed_as("zstd", whole + std::string(std::size_t{10} << 20U, '\0')));
  EXPECT_THAT(stamps_of(drain(*open_log(folder / "a.db3", {}))), ElementsAre(1.0, 2.0)) << "some zeros are no harm";
  put_file(folder / "b.db3", packed_as("zstd", whole + std::string(std::size_t{300} << 20U, '\0')));
  EXPECT_THAT(log_refusal<InputError>(folder / "b.db3"), HasSubstr("as no measured data do"));
}

TEST(SqliteBags, WhatIsPackedIsUnpacked) {
  const TemporaryFolder folder;
  make_database(folder / "a_0.db3", tables() + drive_rows(1.0, 2));
  make_database(folder / "a_1.db3", tables() + drive_rows(3.0, 2));
  make_database(folder / "a_2.db3", tables() + drive_rows(5.0, 2, true));
  run_shell(fmt::format("zstd -q --rm '{}'", folder / "a_0.db3"));
  std::filesystem::rename(folder / "a_0.db3.zst", folder / "a_0.db3.zstd");
  run_shell(fmt::format("gzip '{}'", folder / "a_1.db3"));
  put_file(folder / "metadata.yaml",
           "rosbag2_bagfile_information:\n  compression_format: zstd\n  compression_mode: FILE\n"
           "  relative_file_paths:\n    - a_0.db3.zstd\n    - a_1.db3.gz\n    - a_2.db3\n");
  const WholeLog log = drain(*open_log(folder.path(), {.T_base_laser = Pose2{}}));
  EXPECT_THAT(stamps_of(log), ElementsAre(1.0, 2.0, 3.0, 4.0, 5.0, 6.0));
  EXPECT_TRUE(log.warnings.empty()) << log.warnings.front().first;
}

void put_metadata(const TemporaryFolder& folder, const std::string& files) {
  put_file(folder / "metadata.yaml", "rosbag2_bagfile_information: {relative_file_paths: [" + files + "]}\n");
}

TEST(SqliteBags, FilesOfMcapInAFolder) {
  const TemporaryFolder folder;
  const std::string channel = mcap_channel(1, "/scan", "sensor_msgs/msg/LaserScan", "cdr");
  for (int k = 0; k < 3; ++k) {
    const std::string file = mcap_file(channel + mcap_message(1, k, cdr_scan({.stamp_s = 1.0 + k})));
    put_file(folder / fmt::format("m_{}.mcap", k), k == 1 ? packed_as("zstd", file) : file);
  }
  const std::string packed = packed_as("zstd", cdr_scan({.stamp_s = 4.0}));  // by message
  put_file(folder / "m_3.mcap", mcap_file(channel + mcap_message(1, 3.0, packed)));
  std::filesystem::rename(folder / "m_1.mcap", folder / "m_1.mcap.zstd");
  put_metadata(folder, "m_0.mcap, m_1.mcap.zstd, m_2.mcap, m_3.mcap");
  EXPECT_EQ(drain(*open_log(folder.path(), {})).of<ScanRecord>().size(), 4U);
}

// A recorder that was killed leaves its journal behind, with messages that are nowhere else.
TEST(SqliteBags, AJournalBesideTheBagIsRefused) {
  const TemporaryFolder folder;
  make_database(folder / "j.db3", tables() + drive_rows(1.0, 1));
  put_file(folder / "j.db3-wal", "");
  EXPECT_THAT(stamps_of(drain(*open_log(folder / "j.db3", {}))), ElementsAre(1.0)) << "an empty journal";
  put_file(folder / "j.db3-wal", "x");
  EXPECT_THAT(log_refusal<InputError>(folder / "j.db3"),
              HasSubstr("'sqlite3 FILE \"PRAGMA wal_checkpoint(TRUNCATE)\"'"));
}

TEST(SqliteBags, WhatIsNoBagIsRefused) {
  const TemporaryFolder folder;
  make_database(folder / "other.db3", "CREATE TABLE birds(name TEXT);\n");
  EXPECT_THAT(log_refusal<InputError>(folder / "other.db3"), HasSubstr("topics"));
  make_database(folder / "view.db3",
                "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);\n"
                "CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM n) "
                "SELECT id, 1 AS topic_id, 0 AS timestamp, x'00' AS data FROM n;\n");
  EXPECT_THAT(log_refusal<InputError>(folder / "view.db3"), HasSubstr("topics"));
  put_file(folder / "text.db3", "SQLite format 3 is a fine format");
  EXPECT_NE(log_refusal<InputError>(folder / "text.db3"), "no such error");
  const TemporaryFolder empty;
  EXPECT_THAT(log_refusal<InputError>(empty.path()), HasSubstr("no ROS 2 bag"));
  EXPECT_THAT(log_refusal<FileError>(empty / "none.db3"), HasSubstr("cannot be opened"));
}

TEST(SqliteBags, AMessageThatIsDamagedIsLeftOut) {
  const TemporaryFolder folder;
  const std::string packed = packed_as("zstd", cdr_scan({.stamp_s = 2.0}));
  std::string bomb = packed_as("zstd", std::string(std::size_t{64} << 20U, '\0'));
  const std::vector<std::string> bad{packed.substr(0, packed.size() - 5), bomb, cdr_scan({}).substr(0, 20), ""};
  for (std::size_t k = 0; k < bad.size(); ++k) {
    const std::string file = folder / fmt::format("{}.db3", k);
    make_database(file, tables() + drive_rows(1.0, 1) + insert(3, 2.0, bad[k]) + drive_rows(3.0, 1));
    EXPECT_THAT(log_refusal<InputError>(file), HasSubstr("at message 4")) << k;
    EXPECT_THAT(stamps_of(drain(*open_log(file, {.lenient = true}))), ElementsAre(1.0, 3.0)) << k;
  }
}

// Every byte of the first pages, which describe the others, and at the beginning and the end of every page; else every
// seventh. A cut that keeps whole pages is seen by their number.
TEST(SqliteBags, EachCutIsRefused) {
  constexpr std::size_t kPage = 512;
  const auto is_tried = [](std::size_t size) {
    const std::size_t in_page = size % kPage;
    return size < 2 * kPage || in_page < 12 || in_page > kPage - 8 || size % 7 == 0;
  };
  const TemporaryFolder folder;
  make_database(folder / "whole.db3", tables() + drive_rows(1.0, 4), fmt::format("PRAGMA page_size={};\n", kPage));
  const std::string whole = get_file(folder / "whole.db3");
  ASSERT_EQ(drain(*open_log(folder / "whole.db3", {})).records.size(), 4U);
  for (std::size_t size = 16; size < whole.size(); ++size) {
    if (!is_tried(size)) continue;
    put_file(folder / "cut.db3", whole.substr(0, size));
    const std::string refusal = log_refusal<InputError>(folder / "cut.db3");
    EXPECT_NE(refusal, "no such error") << size;
    EXPECT_EQ(refusal.find('\n'), std::string::npos) << size;
  }
}

struct RealBag {
  std::string file;
  std::size_t scans = 0;
  std::size_t empty = 0;
  std::size_t beams = 0;  ///< of all scans together
};

// The counts are those of Python's sqlite3.
TEST(RecordingsRealData, BagsOfRos2AreReadWhole) {
  const std::vector<RealBag> bags{{"rosbag/lidar_scan", 420, 0, 302400},
                                  {"rosbag/tilt_subset", 276, 33, 123764},
                                  {"rosbag/tilt_lidarServo", 298, 3, 150519}};
  for (const RealBag& bag : bags) {
    GDTSLAM_REAL_DATA(path, bag.file + "/metadata.yaml");
    const auto scans = drain(*open_log(std::filesystem::path(path).parent_path(), {})).of<ScanRecord>();
    EXPECT_EQ(scans.size(), bag.scans) << bag.file;
    std::size_t empty = 0;
    std::size_t beams = 0;
    for (const ScanRecord& scan : scans) {
      empty += scan.scan.ranges_m.empty() ? 1U : 0U;
      beams += scan.scan.ranges_m.size();
    }
    EXPECT_EQ(empty, bag.empty) << bag.file;
    EXPECT_EQ(beams, bag.beams) << bag.file;
  }
}

}  // namespace
}  // namespace gdtslam
