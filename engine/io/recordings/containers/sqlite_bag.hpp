// A ROS 2 bag in one SQLite file (rosbag2's schema versions 1 to 4; also without the table that says which), row after
// row in the order of writing. Only that file is opened, for reading, and its folder is left as it is; a journal (-wal)
// beside it is read too. One bag belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "recording.hpp"

struct sqlite3;       // NOLINT(readability-identifier-naming): SQLite's names
struct sqlite3_blob;  // NOLINT(readability-identifier-naming)
struct sqlite3_stmt;  // NOLINT(readability-identifier-naming)

namespace gdtslam {

inline constexpr std::string_view kSqliteMagic = "SQLite format 3";

class SqliteBag final : public Recording {
 public:
  /// The name is not needed once the bag is open. Throws RecordingFault for what is no bag or cannot be opened.
  explicit SqliteBag(const std::string& path);
  /// A bag in memory, which is copied.
  explicit SqliteBag(std::string_view bytes);
  ~SqliteBag() override;

  std::optional<RecordingItem> next(const Wanted& wanted, const Warn& warn) override;
  /// True behind a message that is damaged in itself; nothing is behind a damaged page.
  bool skip_damage() override { return std::exchange(is_message_fault_, false); }
  [[nodiscard]] std::string place() const override;
  [[nodiscard]] double progress() const override;

 private:
  struct CloseDatabase {
    void operator()(sqlite3* database) const;
  };
  struct FinishStatement {
    void operator()(sqlite3_stmt* statement) const;
  };
  struct CloseBlob {
    void operator()(sqlite3_blob* blob) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, FinishStatement>;

  void open(const std::string& uri, const char* vfs);
  /// The bytes of those pages that are there as a whole.
  std::uint64_t check_size(std::string_view head, std::uint64_t size);
  void leave_out_rest(std::uint64_t whole_bytes);
  void start();
  Statement prepare(const char* sql);
  bool step(Statement& statement);
  /// errno of the reading of the file that failed; 0 where none did.
  [[nodiscard]] int disk_errno() const;
  /// Throws what the code of SQLite means; FileError where the disk failed.
  [[noreturn]] void fail(int code) const;
  void require_tables();
  void read_topics();
  std::string_view message_bytes();
  [[noreturn]] void fail_at_message(const std::string& what);

  struct WholePages;
  std::string path_;                         ///< empty for bytes in memory
  std::unique_ptr<WholePages> whole_pages_;  ///< longer than the database, which calls it
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  Statement messages_;
  std::unique_ptr<sqlite3_blob, CloseBlob> blob_;  ///< of the message that was given last
  std::vector<RecordingItem> channels_;            ///< not given yet, the last one first
  std::int64_t row_ = 0;
  double last_row_ = 0.0;
  bool is_message_fault_ = false;
  bool is_shortened_ = false;  ///< has fewer pages than it states
  std::string data_;
};

}  // namespace gdtslam
