#include "sqlite_bag.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <set>
#include <system_error>
#include <utility>

#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr int kMostCacheKiB = 8192;

/// SQLite takes names as URIs: what means something there is written as its number.
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

std::string text_of(sqlite3_stmt* statement, int column) {
  const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  const int size = sqlite3_column_bytes(statement, column);
  if (text == nullptr) return {};
  return {text, std::min(static_cast<std::size_t>(size), kMostHeaderBytes)};
}

// Of the disk or the system, whatever the file holds.
bool is_of_disk(sqlite3* database) {
  const int kind = sqlite3_errcode(database) & 0xff;
  return kind == SQLITE_CANTOPEN ||
         (kind == SQLITE_IOERR && sqlite3_extended_errcode(database) != SQLITE_IOERR_SHORT_READ);
}

bool is_damage(int code) {
  const int kind = code & 0xff;
  return kind == SQLITE_CORRUPT || kind == SQLITE_NOTADB || kind == SQLITE_FORMAT || kind == SQLITE_NOMEM;
}

// SQLite says so too where a damaged file asks for more than it ever allocates; then nobody was asked for memory. Calls
// that may end so begin with errno 0.
bool is_memory_short(int code) { return (code & 0xff) == SQLITE_NOMEM && errno == ENOMEM; }

MessageEncoding sqlite_encoding(std::string_view name) {
  if (name == "cdr" || name.empty()) return MessageEncoding::kCdr;
  return name == "ros1" ? MessageEncoding::kRos1 : MessageEncoding::kOther;
}

}  // namespace

/// Of a file whose last page is cut: SQLite would fill that up with zeros, and take them for rows and messages.
struct SqliteBag::WholePages {
  sqlite3_io_methods methods;  ///< the first member, to which the file points
  const sqlite3_io_methods* methods_of_file;
  sqlite3_int64 bytes;

  static int read(sqlite3_file* file, void* bytes, int count, sqlite3_int64 offset) {
    const auto* const pages = reinterpret_cast<const WholePages*>(file->pMethods);
    if (offset + count > pages->bytes) return SQLITE_CORRUPT;
    return pages->methods_of_file->xRead(file, bytes, count, offset);
  }
};

void SqliteBag::CloseDatabase::operator()(sqlite3* database) const { sqlite3_close(database); }
void SqliteBag::CloseBlob::operator()(sqlite3_blob* blob) const { sqlite3_blob_close(blob); }
void SqliteBag::FinishStatement::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
SqliteBag::~SqliteBag() = default;

// A journal is read by this process alone, with locks and index in memory, so that nothing is written beside the bag.
SqliteBag::SqliteBag(const std::string& path) : path_(path) {
  constexpr std::size_t kHeadBytes = 100;
  std::error_code no_journal;
  const std::uintmax_t journal_bytes = std::filesystem::file_size(path + "-wal", no_journal);
  const bool has_journal = !no_journal && journal_bytes > 0;
  open(sqlite_uri(path, has_journal ? "?mode=ro" : "?mode=ro&immutable=1"), "unix-none");
  std::string head(kHeadBytes, '\0');
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  if (!has_journal && size > 0 && file.seekg(0).read(head.data(), kHeadBytes)) {
    const auto bytes = static_cast<std::uint64_t>(size);
    if (const std::uint64_t whole_bytes = check_size(head, bytes); whole_bytes < bytes) leave_out_rest(whole_bytes);
  }
  if (file.bad()) throw FileError(path, "cannot be read");
  start();
}

SqliteBag::SqliteBag(std::string_view bytes) {
  open("file::memory:", nullptr);
  bytes = bytes.substr(0, check_size(bytes, bytes.size()));
  auto* const copy = static_cast<unsigned char*>(sqlite3_malloc64(std::max<std::size_t>(bytes.size(), 1)));
  if (copy == nullptr) throw std::bad_alloc();
  std::memcpy(copy, bytes.data(), bytes.size());
  const auto size = static_cast<sqlite3_int64>(bytes.size());
  const unsigned flags = SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_READONLY;
  errno = 0;
  if (const int code = sqlite3_deserialize(database_.get(), "main", copy, size, size, flags); code != SQLITE_OK) {
    fail(code);
  }
  start();
}

// The head states the number of pages, where the program that wrote last keeps it (its two counters agree).
std::uint64_t SqliteBag::check_size(std::string_view head, std::uint64_t size) {
  const auto number = [&](std::size_t at, std::size_t bytes) {
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < bytes; ++k) value = 256 * value + static_cast<unsigned char>(head[at + k]);
    return value;
  };
  if (head.size() < 100) return size;
  const std::uint64_t page_bytes = number(16, 2) == 1 ? 65536 : number(16, 2);
  if (number(24, 4) == number(92, 4)) is_shortened_ = page_bytes * number(28, 4) > size;
  return page_bytes == 0 || size < page_bytes ? size : size - size % page_bytes;
}

void SqliteBag::leave_out_rest(std::uint64_t whole_bytes) {
  sqlite3_file* file = nullptr;
  (void)sqlite3_file_control(database_.get(), "main", SQLITE_FCNTL_FILE_POINTER, &file);
  if (file == nullptr || file->pMethods == nullptr) return;
  whole_pages_ = std::make_unique<WholePages>(WholePages{
      .methods = *file->pMethods, .methods_of_file = file->pMethods, .bytes = static_cast<sqlite3_int64>(whole_bytes)});
  whole_pages_->methods.xRead = WholePages::read;
  file->pMethods = &whole_pages_->methods;
}

void SqliteBag::open(const std::string& uri, const char* vfs) {
  sqlite3* database = nullptr;
  errno = 0;
  const int flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX;
  const int code = sqlite3_open_v2(uri.c_str(), &database, flags, vfs);
  database_.reset(database);
  if (code != SQLITE_OK) fail(code);
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(kMostMessageBytes) + 4096);
  sqlite3_db_config(database, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
}

void SqliteBag::start() {
  // A bag that was cut has fewer pages than it states; those that are there can be read all the same.
  const std::string cache = fmt::format("PRAGMA cache_size=-{}", kMostCacheKiB);
  for (const char* const pragma : {"PRAGMA locking_mode=EXCLUSIVE", "PRAGMA writable_schema=ON", cache.c_str()}) {
    errno = 0;
    const int code = sqlite3_exec(database_.get(), pragma, nullptr, nullptr, nullptr);
    if (code != SQLITE_OK && disk_errno() != 0) fail(code);
  }
  require_tables();
  read_topics();
  Statement last = prepare("SELECT max(id) FROM messages");
  try {
    if (step(last)) last_row_ = sqlite3_column_double(last.get(), 0);
  } catch (const RecordingFault&) {  // its last page is not there: no progress is told
  }
  messages_ = prepare("SELECT id, topic_id, timestamp FROM messages ORDER BY id");
}

// SQLite calls a page that the disk does not give malformed, as one that is.
int SqliteBag::disk_errno() const {
  int reason = 0;
  if (database_) (void)sqlite3_file_control(database_.get(), "main", SQLITE_FCNTL_LAST_ERRNO, &reason);
  if (reason == 0 && database_ && is_of_disk(database_.get())) reason = sqlite3_system_errno(database_.get());
  return reason;
}

void SqliteBag::fail(int code) const {
  if (is_memory_short(code)) throw std::bad_alloc();
  if (const int reason = disk_errno(); reason != 0) {
    throw FileError(path_, fmt::format("cannot be read: {}", std::generic_category().message(reason)));
  }
  const bool is_too_much = (code & 0xff) == SQLITE_NOMEM;
  const std::string why = is_too_much
                              ? "it asks for more memory than any bag"
                              : one_line(database_ ? sqlite3_errmsg(database_.get()) : sqlite3_errstr(code), 200);
  if (!is_damage(code)) throw RecordingFault(fmt::format("cannot be read as a ROS 2 bag: {}", why));
  if (row_ > 0) throw RecordingCut(fmt::format("is damaged or was cut off ({})", why));
  throw RecordingFault(fmt::format("is damaged or was cut off ({}); 'sqlite3 FILE .recover' saves what there is", why));
}

SqliteBag::Statement SqliteBag::prepare(const char* sql) {
  sqlite3_stmt* statement = nullptr;
  errno = 0;
  const int code = sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr);
  if (code != SQLITE_OK) fail(code);
  return Statement(statement);
}

bool SqliteBag::step(Statement& statement) {
  errno = 0;
  const int code = sqlite3_step(statement.get());
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) fail(code);
  return false;
}

// Views could be without end.
void SqliteBag::require_tables() {
  Statement tables =
      prepare("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages')");
  if (step(tables) && sqlite3_column_int(tables.get(), 0) == 2) return;
  throw RecordingFault("is an SQLite file without the tables 'topics' and 'messages' of a ROS 2 bag");
}

// Later versions have more columns; these four have been there from the first.
void SqliteBag::read_topics() {
  Statement topics = prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id DESC");
  while (step(topics) && channels_.size() < kMostChannels) {
    RecordingChannel channel;
    channel.topic = text_of(topics.get(), 1);
    channel.type = text_of(topics.get(), 2);
    channel.encoding_name = text_of(topics.get(), 3);
    channel.encoding = sqlite_encoding(channel.encoding_name);
    const auto number = static_cast<std::uint32_t>(sqlite3_column_int64(topics.get(), 0));
    channels_.push_back({.channel = number, .definition = std::move(channel)});
  }
}

void SqliteBag::fail_at_message(const std::string& what) {
  is_message_fault_ = true;
  throw RecordingFault(what);
}

// Only what is wanted leaves the file: the pages of a camera's pictures are passed over.
std::string_view SqliteBag::message_bytes() {
  sqlite3_blob* blob = blob_.get();
  errno = 0;
  const int code = blob == nullptr ? sqlite3_blob_open(database_.get(), "main", "messages", "data", row_, 0, &blob)
                                   : sqlite3_blob_reopen(blob, row_);
  if (blob != blob_.get()) blob_.reset(blob);
  if (code != SQLITE_OK) {
    blob_.reset();
    if (code != SQLITE_ERROR) fail(code);
    fail_at_message("has a message without bytes");
  }
  const auto size = static_cast<std::size_t>(sqlite3_blob_bytes(blob));
  if (size > kMostMessageBytes) {
    fail_at_message(fmt::format("has a message of {} bytes; at most {} are read", size, kMostMessageBytes));
  }
  data_.resize(size);
  errno = 0;
  if (const int read = sqlite3_blob_read(blob, data_.data(), static_cast<int>(size), 0); read != SQLITE_OK) fail(read);
  return data_;
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
    if (is_shortened_) throw RecordingCut("ends before the pages that it states");
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
