// The reader of SQLite bags by itself: what it counts, bounds, orders and says. SQLite makes the databases.
#include "engine/io/recordings/containers/sqlite_bag.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/files/interruption.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

const std::string kEmptyTables =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);";
const std::string kOneTopic = kEmptyTables + "INSERT INTO topics VALUES(1, '/scan', 'a/msg/B', 'cdr');";

/// A database of these commands; its name again.
std::string made_by_sqlite(const std::string& file, const std::string& commands) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, commands.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
  EXPECT_EQ(sqlite3_close(database), SQLITE_OK);
  return file;
}

std::string bag_row(int id, const std::string& timestamp_ns = "0", const std::string& data = "x'07'") {
  return fmt::format("INSERT INTO messages VALUES({}, 1, {}, {});", id, timestamp_ns, data);
}

std::optional<RecordingItem> next_item_of(SqliteBag& bag, bool is_wanted = true) {
  return bag.next([is_wanted](std::uint32_t) { return is_wanted; }, [](std::string_view, const std::string&) {});
}

/// The number of channels, which come first.
std::size_t skip_channels(SqliteBag& bag, RecordingItem& first_message) {
  std::size_t channels = 0;
  for (std::optional<RecordingItem> item = next_item_of(bag); item; item = next_item_of(bag)) {
    if (!item->definition) {
      first_message = *item;
      break;
    }
    ++channels;
  }
  return channels;
}

struct Refusal {
  std::string text{};
  bool is_cut = false;
};

/// What ends the reading of a bag; nothing where it comes to its end. `given` counts its messages.
Refusal refusal_of(const std::string& file, std::size_t* given = nullptr) {
  try {
    SqliteBag bag(file);
    while (const std::optional<RecordingItem> item = next_item_of(bag)) {
      if (given != nullptr && !item->definition) ++*given;
    }
  } catch (const RecordingFault& fault) {
    return {fault.what(), dynamic_cast<const RecordingCut*>(&fault) != nullptr};
  }
  return {};
}

TEST(SqliteBag, NamesMayHoldWhatMeansSomethingInAUri) {
  const TemporaryFolder folder;
  for (const char* const name : {"a?mode=rwc.db3", "a#b.db3", "a%41.db3", "ü b&c=d.db3"}) {
    SqliteBag bag(made_by_sqlite(folder / name, kOneTopic + bag_row(1)));
    RecordingItem message;
    EXPECT_EQ(skip_channels(bag, message), 1U) << name;
    EXPECT_EQ(message.bytes, "\x07") << name;
  }
}

TEST(SqliteBag, TimesAreSecondsOfNanoseconds) {
  const TemporaryFolder folder;
  const std::string file = made_by_sqlite(
      folder / "a.db3", kOneTopic + bag_row(1, "0") + bag_row(2, "1") + bag_row(3, "999999999") +
                            bag_row(4, "1000000000") + bag_row(5, "1700000000600000000") + bag_row(6, "-1500000000"));
  SqliteBag bag(file);
  std::vector<double> times_s;
  while (const std::optional<RecordingItem> item = next_item_of(bag)) {
    if (!item->definition) times_s.push_back(item->received_s);
  }
  ASSERT_EQ(times_s.size(), 6U);
  const std::vector<double> expected_s{0.0, 1e-9, 0.999999999, 1.0, 1700000000.6, -1.5};
  for (std::size_t k = 0; k < times_s.size(); ++k) EXPECT_DOUBLE_EQ(times_s[k], expected_s[k]) << k;
}

// What is no plain table of rosbag2 could be rows without end, or a program.
TEST(SqliteBag, OnlyPlainTablesAreRead) {
  const TemporaryFolder folder;
  const std::string topics =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);";
  const std::string columns = "topic_id INTEGER, timestamp INTEGER, data BLOB";
  const std::string no_bag = "is an SQLite file without the tables 'topics' and 'messages' of a ROS 2 bag";
  const std::string computed = "has a computed column in its table 'messages', which no recorder writes";
  const std::vector<std::pair<std::string, std::string>> kinds{
      {"CREATE TABLE messages(id INTEGER, " + columns + ");", no_bag},
      {"CREATE TABLE messages(id TEXT PRIMARY KEY, " + columns + ");", no_bag},
      {"CREATE VIEW messages AS SELECT 1 AS id, 1 AS topic_id, 1 AS timestamp, x'' AS data;", no_bag},
      {"CREATE VIRTUAL TABLE messages USING fts5(id, topic_id, timestamp, data);", no_bag},
      {"CREATE TABLE messages(id INTEGER PRIMARY KEY, timestamp INTEGER, data BLOB, topic_id INTEGER AS (hex(id)));",
       computed},
      {"CREATE TABLE messages(id INTEGER PRIMARY KEY, " + columns + ", a INTEGER AS (hex(id)) STORED);", computed}};
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const std::string file = made_by_sqlite(folder / fmt::format("{}.db3", k), topics + kinds[k].first);
    EXPECT_EQ(refusal_of(file).text, kinds[k].second) << kinds[k].first;
  }
}

// The index of such a key is no help with the order, so that all rows are sorted before the first one.
TEST(SqliteBag, ARowTakesABoundedNumberOfSteps) {
  const TemporaryFolder folder;
  const auto refusal_with = [&](int rows) {
    return refusal_of(made_by_sqlite(
        folder / fmt::format("{}.db3", rows),
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
        "CREATE TABLE messages(id INTEGER, topic_id INTEGER, timestamp INTEGER, data BLOB, "
        "PRIMARY KEY(id COLLATE NOCASE, topic_id));" +
            fmt::format("WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL SELECT id + 1 FROM n WHERE id < {}) "
                        "INSERT INTO messages SELECT id, 1, 1, x'07' FROM n;",
                        rows)));
  };
  EXPECT_EQ(refusal_with(1000).text, "");
  EXPECT_EQ(refusal_with(300'000).text, "takes more steps for a row than any bag");
}

TEST(SqliteBag, WhatTakesLongEndsWhenTheProcessIsAskedTo) {
  const TemporaryFolder folder;
  std::string views;
  for (int k = 0; k < 2000; ++k) views += fmt::format("CREATE VIEW v{} AS SELECT 1;", k);
  const std::string file = made_by_sqlite(folder / "a.db3", "BEGIN;" + kOneTopic + views + "COMMIT;");
  EXPECT_EQ(refusal_of(file).text, "");
  asked_to_end = [] { return true; };
  try {
    (void)refusal_of(file);
    ADD_FAILURE() << "not interrupted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kInterrupted);
  }
  asked_to_end = nullptr;
}

// docs/formats.md: a message has at most 16 MiB. A longer one is damage to who wants it, and passed over else.
TEST(SqliteBag, AMessageOf16MiBIsReadAndNoLongerOne) {
  const TemporaryFolder folder;
  const std::string file = made_by_sqlite(folder / "a.db3", kOneTopic + bag_row(1, "0", "zeroblob(16777216)") +
                                                                bag_row(2, "0", "zeroblob(16777217)") + bag_row(3));
  SqliteBag bag(file);
  RecordingItem message;
  ASSERT_EQ(skip_channels(bag, message), 1U);
  EXPECT_EQ(message.bytes.size(), 16777216U);
  try {
    (void)next_item_of(bag);
    ADD_FAILURE() << "the longer one was read";
  } catch (const RecordingFault& fault) {
    EXPECT_STREQ(fault.what(), "has a message of 16777217 bytes; at most 16777216 are read");
  }

  SqliteBag unwanted(file);
  std::size_t messages = 0;
  while (const std::optional<RecordingItem> item = next_item_of(unwanted, false)) {
    messages += item->definition ? 0U : 1U;
    EXPECT_TRUE(item->bytes.empty());
  }
  EXPECT_EQ(messages, 3U);
}

/// A bag of pages of that size whose last ones hold what nobody asks for.
std::string with_pages_behind(const std::string& file, int page_bytes) {
  return made_by_sqlite(file, fmt::format("PRAGMA page_size={};", page_bytes) + kOneTopic + bag_row(1) + bag_row(2) +
                                  "CREATE TABLE pictures(data BLOB); INSERT INTO pictures VALUES(zeroblob(200000));");
}

// www.sqlite.org/fileformat.html: the size of a page is at byte 16, where 1 means 65536, and their number at byte 28.
TEST(SqliteBag, ABagWithFewerPagesThanItStatesIsRefused) {
  const TemporaryFolder folder;
  for (const int page_bytes : {512, 4096, 32768, 65536}) {
    const std::string file = with_pages_behind(folder / fmt::format("{}.db3", page_bytes), page_bytes);
    const std::string whole = get_file(file);
    ASSERT_EQ(whole.size() % static_cast<std::size_t>(page_bytes), 0U);
    ASSERT_EQ(256 * static_cast<unsigned char>(whole[16]) + static_cast<unsigned char>(whole[17]),
              page_bytes == 65536 ? 1 : page_bytes);
    EXPECT_EQ(refusal_of(file).text, "") << page_bytes;
    for (const std::size_t missing : {std::size_t{1}, static_cast<std::size_t>(page_bytes)}) {
      const std::string part = whole.substr(0, whole.size() - missing);
      const std::string cut = folder / "cut.db3";
      put_file(cut, part);
      put_file(cut + "-wal", "");  // of a recorder that had just emptied it
      const Refusal refusal = refusal_of(cut);
      EXPECT_THAT(refusal.text, testing::HasSubstr("was cut off")) << page_bytes << " without " << missing;
      EXPECT_THAT(refusal.text, EndsWith("'sqlite3 FILE .recover' saves what there is"));
    }
  }
}

// Rows that are added go into new pages, so the last page of the file has the last ones.
TEST(SqliteBag, WhatIsBeforeADamagedPageIsGiven) {
  const TemporaryFolder folder;
  std::string rows;
  for (int k = 1; k <= 40; ++k) rows += bag_row(k, "0", "zeroblob(100)");
  std::string bytes = get_file(made_by_sqlite(folder / "a.db3", "PRAGMA page_size=512;" + kOneTopic + rows));
  std::fill(bytes.end() - 512, bytes.end(), '\xff');
  put_file(folder / "a.db3", bytes);
  std::size_t given = 0;
  const Refusal refusal = refusal_of(folder / "a.db3", &given);
  EXPECT_THAT(refusal.text, StartsWith("is damaged or was cut off ("));
  EXPECT_THAT(refusal.text, EndsWith(")"));
  EXPECT_TRUE(refusal.is_cut);
  EXPECT_GE(given, 35U) << "a page of 512 bytes holds four of them";
  EXPECT_LT(given, 40U);
  EXPECT_EQ(SqliteBag(folder / "a.db3").progress(), -1.0) << "the last row is not known";
}

}  // namespace
}  // namespace gdtslam
