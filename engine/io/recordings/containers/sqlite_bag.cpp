#include "sqlite_bag.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include "engine/core/files/interruption.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr int kMostCacheKiB = 8192;
// A row of a bag takes some ten steps of SQLite; a million take less than a second.
constexpr int kStepsBetweenQuestions = 1000;
constexpr int kMostQuestions = 1000;
constexpr std::string_view kRecoverHint = "'sqlite3 FILE .recover' saves what there is";

/// SQLite takes names as URIs, so characters with a meaning in URIs are escaped.
std::string sqlite_uri(const std::string& path, std::string_view parameters) {
  std::string uri = "file:";
  for (const char letter : std::filesystem::absolute(path).string()) {
    if (letter == '?' || letter == '#' || letter == '%') {
      uri += fmt::format("%{:02x}", static_cast<unsigned>(letter));
    } else {
      uri += letter;
    }
  }
  return uri + std::string(parameters);
}

std::string column_text(sqlite3_stmt* statement, int column) {
  const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  const int size = sqlite3_column_bytes(statement, column);
  if (text == nullptr) return {};
  return {text, std::min(static_cast<std::size_t>(size), kMostHeaderBytes)};
}

// True for a fault of the disk or the system, not of the file's content.
bool is_disk_fault(sqlite3* database) {
  const int kind = sqlite3_errcode(database) & 0xff;
  return kind == SQLITE_CANTOPEN ||
         (kind == SQLITE_IOERR && sqlite3_extended_errcode(database) != SQLITE_IOERR_SHORT_READ);
}

bool is_damage(int code) {
  const int kind = code & 0xff;
  return kind == SQLITE_CORRUPT || kind == SQLITE_NOTADB || kind == SQLITE_FORMAT || kind == SQLITE_NOMEM;
}

MessageEncoding sqlite_encoding(std::string_view name) {
  if (name == "cdr" || name.empty()) return MessageEncoding::kCdr;
  return name == "ros1" ? MessageEncoding::kRos1 : MessageEncoding::kOther;
}

// Our statements read only these tables and call no function. Computed columns of a database would call one.
int allow_reading_alone(void* /*unused*/, int action, const char* table, const char* /*column*/,
                        const char* /*database*/, const char* /*trigger*/) {
  constexpr std::array<std::string_view, 3> kTables{"sqlite_master", "topics", "messages"};
  if (action == SQLITE_SELECT) return SQLITE_OK;
  const bool is_known = table != nullptr && std::find(kTables.begin(), kTables.end(), table) != kTables.end();
  return action == SQLITE_READ && is_known ? SQLITE_OK : SQLITE_DENY;
}

}  // namespace

void SqliteBag::CloseDatabase::operator()(sqlite3* database) const { sqlite3_close(database); }
void SqliteBag::FinishStatement::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
SqliteBag::~SqliteBag() = default;

// Without a journal nothing is written beside the bag.
SqliteBag::SqliteBag(const std::string& path) : path_(path) {
  std::error_code error;
  if (const std::uintmax_t bytes = std::filesystem::file_size(path + "-wal", error); !error && bytes > 0) {
    throw RecordingFault(
        "has messages in its journal (-wal), as its recorder was killed; 'sqlite3 FILE \"PRAGMA "
        "wal_checkpoint(TRUNCATE)\"' moves "
        "them into the file");
  }
  sqlite3* database = nullptr;
  const int flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX;
  const int code = sqlite3_open_v2(sqlite_uri(path, "?mode=ro&immutable=1").c_str(), &database, flags, "unix-none");
  database_.reset(database);
  if (code != SQLITE_OK) fail(code);
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(kMostMessageBytes) + 4096);
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_progress_handler(database, kStepsBetweenQuestions, ask_to_end, this);
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw FileError(path, fmt::format("cannot be read: {}", error.message()));
  start(size);
}

// A request to end does not interrupt a short row: the reader ends between two rows.
int SqliteBag::ask_to_end(void* bag) {
  const int asked = ++static_cast<SqliteBag*>(bag)->asked_;
  return asked > kMostQuestions || (asked > 1 && is_asked_to_end()) ? 1 : 0;
}

void SqliteBag::start(std::uint64_t size) {
  Statement cache = prepare(fmt::format("PRAGMA cache_size=-{}", kMostCacheKiB).c_str());
  (void)step(cache);
  require_whole_pages(size);
  require_plain_table("topics");
  require_plain_table("messages");
  sqlite3_set_authorizer(database_.get(), allow_reading_alone, nullptr);
  read_topics();
  try {
    Statement last = prepare("SELECT id FROM messages ORDER BY id DESC LIMIT 1");
    if (step(last)) last_row_ = sqlite3_column_double(last.get(), 0);
  } catch (const RecordingFault&) {  // its last page is damaged, so the progress is unknown
  }
  messages_ = prepare("SELECT id, topic_id, timestamp FROM messages ORDER BY id");
  bytes_ = prepare("SELECT data FROM messages WHERE id = ?");
}

// SQLite fills a cut page with zeros, and would read them as messages.
void SqliteBag::require_whole_pages(std::uint64_t size) {
  Statement page = prepare("PRAGMA page_size");
  const auto bytes = step(page) ? static_cast<std::uint64_t>(sqlite3_column_int64(page.get(), 0)) : 0;
  if (bytes == 0 || size % bytes != 0) {
    throw RecordingFault(fmt::format("was cut off within a page; {}", kRecoverHint));
  }
}

// A view may have endless rows, and a computed column may run any expression of its author.
void SqliteBag::require_plain_table(const std::string& name) {
  constexpr const char* kNoBag = "is an SQLite file without the tables 'topics' and 'messages' of a ROS 2 bag";
  Statement table = prepare("SELECT rootpage FROM sqlite_master WHERE type = 'table' AND name = ?");
  sqlite3_bind_text(table.get(), 1, name.c_str(), -1, SQLITE_TRANSIENT);
  if (!step(table) || sqlite3_column_int64(table.get(), 0) == 0) throw RecordingFault(kNoBag);
  bool has_key = false;
  Statement columns = prepare(("PRAGMA table_xinfo(" + name + ")").c_str());
  while (step(columns)) {
    if (sqlite3_column_int(columns.get(), 6) != 0) {
      throw RecordingFault(fmt::format("has a computed column in its table '{}', which no recorder writes", name));
    }
    const bool is_number = column_text(columns.get(), 1) == "id" && column_text(columns.get(), 2) == "INTEGER";
    has_key = has_key || (is_number && sqlite3_column_int(columns.get(), 5) == 1);
  }
  if (!has_key) throw RecordingFault(kNoBag);
}

// SQLite reports a page that the disk cannot read as malformed, so errno distinguishes the two.
int SqliteBag::disk_errno() const {
  int reason = 0;
  if (database_) (void)sqlite3_file_control(database_.get(), "main", SQLITE_FCNTL_LAST_ERRNO, &reason);
  if (reason == 0 && database_ && is_disk_fault(database_.get())) reason = sqlite3_system_errno(database_.get());
  return reason;
}

void SqliteBag::fail(int code) const {
  if ((code & 0xff) == SQLITE_INTERRUPT) {
    if (is_asked_to_end()) {
      throw Error(ExitCode::kInterrupted, fmt::format("interrupted while '{}' was read", one_line(path_)));
    }
    throw RecordingFault("takes more steps for a row than any bag");
  }
  if (const int reason = disk_errno(); reason != 0) {
    throw FileError(path_, fmt::format("cannot be read: {}", std::generic_category().message(reason)));
  }
  const std::string why = one_line(database_ ? sqlite3_errmsg(database_.get()) : sqlite3_errstr(code), 200);
  if (!is_damage(code)) throw RecordingFault(fmt::format("cannot be read as a ROS 2 bag: {}", why));
  if (row_ > 0) throw RecordingCut(fmt::format("is damaged or was cut off ({})", why));
  throw RecordingFault(fmt::format("is damaged or was cut off ({}); {}", why, kRecoverHint));
}

SqliteBag::Statement SqliteBag::prepare(const char* sql) {
  sqlite3_stmt* statement = nullptr;
  asked_ = 0;
  const int code = sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr);
  if (code != SQLITE_OK) fail(code);
  return Statement(statement);
}

bool SqliteBag::step(Statement& statement) {
  asked_ = 0;
  const int code = sqlite3_step(statement.get());
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) fail(code);
  return false;
}

// Later versions have more columns; all versions have these four.
void SqliteBag::read_topics() {
  Statement topics = prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id DESC");
  while (step(topics) && channels_.size() < kMostChannels) {
    RecordingChannel channel;
    channel.topic = column_text(topics.get(), 1);
    channel.type = column_text(topics.get(), 2);
    channel.encoding_name = column_text(topics.get(), 3);
    channel.encoding = sqlite_encoding(channel.encoding_name);
    const auto number = static_cast<std::uint32_t>(sqlite3_column_int64(topics.get(), 0));
    channels_.push_back({.channel = number, .definition = std::move(channel)});
  }
}

// Reads only wanted messages: pages with a camera's pictures are skipped.
std::string_view SqliteBag::message_bytes() {
  sqlite3_reset(bytes_.get());
  sqlite3_bind_int64(bytes_.get(), 1, row_);
  if (!step(bytes_) || sqlite3_column_type(bytes_.get(), 0) != SQLITE_BLOB) {
    throw RecordingFault("has a message without bytes");
  }
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(bytes_.get(), 0));
  if (size > kMostMessageBytes) {
    throw RecordingFault(fmt::format("has a message of {} bytes; at most {} are read", size, kMostMessageBytes));
  }
  return {static_cast<const char*>(sqlite3_column_blob(bytes_.get(), 0)), size};
}

std::optional<RecordingItem> SqliteBag::next(const Wanted& wanted, const Warn& /*warn*/) {
  if (!channels_.empty()) {
    RecordingItem item = std::move(channels_.back());
    channels_.pop_back();
    return item;
  }
  if (!messages_) return std::nullopt;
  if (!step(messages_)) {
    messages_.reset();
    return std::nullopt;
  }
  const std::int64_t row = sqlite3_column_int64(messages_.get(), 0);
  if (row_ > 0 && row <= row_) throw RecordingFault("is damaged: its messages are not in order");
  row_ = row;
  RecordingItem item{.channel = static_cast<std::uint32_t>(sqlite3_column_int64(messages_.get(), 1))};
  const std::int64_t time_ns = sqlite3_column_int64(messages_.get(), 2);
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t whole_s = time_ns / kSecond_ns;
  item.received_s = static_cast<double>(whole_s) + 1.0e-9 * static_cast<double>(time_ns % kSecond_ns);
  if (wanted(item.channel)) item.bytes = message_bytes();
  return item;
}

std::string SqliteBag::place() const { return fmt::format("at message {}", row_); }

double SqliteBag::progress() const {
  return last_row_ > 0.0 ? std::min(1.0, static_cast<double>(row_) / last_row_) : -1.0;
}

}  // namespace gdtslam
