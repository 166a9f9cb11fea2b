#include "ros2_database.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <filesystem>

#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

// The tables of rosbag2 up to Humble. Nothing but this process sees the file before it has its name: SQLite needs no
// journal and no locks.
constexpr std::string_view kRos2Tables =
    "PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; BEGIN;"
    "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL);"
    "INSERT INTO schema(schema_version,ros_distro) VALUES(3,'humble');"
    "CREATE TABLE metadata(id INTEGER PRIMARY KEY,metadata_version INTEGER NOT NULL,metadata TEXT NOT NULL);"
    "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
    "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL,"
    "data BLOB NOT NULL);";

std::string yaml_in_quotes(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '\n') {
      quoted += "\\n";
      continue;
    }
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

std::string ros2_database_of(std::string folder) {
  while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
  return folder + "/" + std::filesystem::path(folder).filename().string() + "_0.db3";
}

void Ros2DatabaseWriter::CloseDatabase::operator()(sqlite3* database) const { sqlite3_close_v2(database); }
void Ros2DatabaseWriter::FreeStatement::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Ros2DatabaseWriter::Ros2DatabaseWriter(const std::string& path, AtomicFileSet& files, bool has_folder) {
  namespace fs = std::filesystem;
  std::string database = path;
  if (has_folder) {
    database = ros2_database_of(path);
    make_folder(fs::path(database).parent_path().string());
  }
  database_name_ = fs::path(database).filename().string();
  file_ = &files.add(database);
  if (has_folder) metadata_ = &files.add((fs::path(database).parent_path() / kRos2Metadata).string());
  sqlite3* opened = nullptr;
  const int status = sqlite3_open_v2(file_->written_path().c_str(), &opened, SQLITE_OPEN_READWRITE, "unix-none");
  database_.reset(opened);
  check(status);
  run(std::string(kRos2Tables));
  insert_ = prepared("INSERT INTO messages(topic_id,timestamp,data) VALUES(?,?,?)");
}

void Ros2DatabaseWriter::check(int status) const {
  if (status == SQLITE_OK || status == SQLITE_DONE || status == SQLITE_ROW) return;
  throw FileError(file_->path(), fmt::format("cannot be written: {}", one_line(sqlite3_errstr(status))));
}

void Ros2DatabaseWriter::run(const std::string& commands) {
  check(sqlite3_exec(database_.get(), commands.c_str(), nullptr, nullptr, nullptr));
}

Ros2DatabaseWriter::Statement Ros2DatabaseWriter::prepared(const std::string& command) {
  sqlite3_stmt* statement = nullptr;
  check(sqlite3_prepare_v2(database_.get(), command.c_str(), -1, &statement, nullptr));
  return Statement(statement);
}

void Ros2DatabaseWriter::step(sqlite3_stmt* statement) {
  check(sqlite3_step(statement));
  check(sqlite3_reset(statement));
}

std::uint32_t Ros2DatabaseWriter::add_channel(const std::string& topic, RosType type, bool is_latched) {
  const auto number = static_cast<std::uint32_t>(topics_.size() + 1);
  topics_.push_back({topic, ros_type_name(type, RosEncoding::kCdr), ros2_service_quality(is_latched)});
  const Statement statement = prepared("INSERT INTO topics VALUES(?,?,?,'cdr',?)");
  check(sqlite3_bind_int(statement.get(), 1, static_cast<int>(number)));
  int column = 2;
  for (const std::string* text : {&topics_.back().name, &topics_.back().type, &topics_.back().quality}) {
    check(sqlite3_bind_text(statement.get(), column++, text->c_str(), -1, nullptr));
  }
  step(statement.get());
  return number;
}

void Ros2DatabaseWriter::add(std::uint32_t channel, std::int64_t received_ns, std::string_view message) {
  first_ns_ = messages_ == 0 ? received_ns : std::min(first_ns_, received_ns);
  last_ns_ = messages_ == 0 ? received_ns : std::max(last_ns_, received_ns);
  ++messages_;
  ++topics_[channel - 1].messages;
  bytes_ += message.size();
  check(sqlite3_bind_int(insert_.get(), 1, static_cast<int>(channel)));
  check(sqlite3_bind_int64(insert_.get(), 2, received_ns));
  check(sqlite3_bind_blob64(insert_.get(), 3, message.data(), message.size(), nullptr));
  step(insert_.get());
}

std::string Ros2DatabaseWriter::metadata() const {
  const auto times = [this](std::string_view indent) {
    return fmt::format(
        "{0}duration:\n{0}  nanoseconds: {1}\n{0}starting_time:\n{0}  nanoseconds_since_epoch: {2}\n"
        "{0}message_count: {3}\n",
        indent, last_ns_ - first_ns_, first_ns_, messages_);
  };
  std::string text = "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n" + times("  ") +
                     "  topics_with_message_count:\n";
  for (const Topic& topic : topics_) {
    text += fmt::format(
        "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n"
        "        offered_qos_profiles: {}\n      message_count: {}\n",
        topic.name, topic.type, yaml_in_quotes(topic.quality), topic.messages);
  }
  const std::string file = yaml_in_quotes(database_name_);
  return text +
         fmt::format(
             "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n    - {0}\n"
             "  files:\n    - path: {0}\n",
             file) +
         times("      ");
}

void Ros2DatabaseWriter::finish() {
  run("CREATE INDEX timestamp_idx ON messages (timestamp ASC); COMMIT;");
  insert_.reset();
  database_.reset();
  if (metadata_ != nullptr) metadata_->write(metadata());
}

}  // namespace gdtslam
