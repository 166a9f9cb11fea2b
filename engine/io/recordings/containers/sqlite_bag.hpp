// Reads a ROS 2 bag in one SQLite file (rosbag2's schema versions 1 to 4, also without the version's table), row by row
// in the order of writing. Only that file is opened, for reading; its folder is not changed. A stranger's database can
// contain code, so only plain tables are read, and each row ends after a bounded number of steps or when the process is
// asked to end. One bag belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recording.hpp"

struct sqlite3;       // NOLINT(readability-identifier-naming): SQLite's names
struct sqlite3_stmt;  // NOLINT(readability-identifier-naming)

namespace gdtslam {

inline constexpr std::string_view kSqliteMagic = "SQLite format 3";

class SqliteBag final : public Recording {
 public:
  /// The file may be renamed once the bag is open. Throws RecordingFault if it is no bag or cannot be opened.
  explicit SqliteBag(const std::string& path);
  ~SqliteBag() override;

  std::optional<RecordingItem> next(const Wanted& wanted, const Warn& warn) override;
  [[nodiscard]] std::string place() const override;
  [[nodiscard]] double progress() const override;

 private:
  struct CloseDatabase {
    void operator()(sqlite3* database) const;
  };
  struct FinishStatement {
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, FinishStatement>;

  /// `size` of the database in bytes.
  void start(std::uint64_t size);
  void require_whole_pages(std::uint64_t size);
  void require_plain_table(const std::string& name);
  Statement prepare(const char* sql);
  bool step(Statement& statement);
  /// errno of a failed read of the file; 0 if none failed.
  [[nodiscard]] int disk_errno() const;
  /// Throws the error for SQLite's code; FileError if the disk failed.
  [[noreturn]] void fail(int code) const;
  void read_topics();
  std::string_view message_bytes();
  static int ask_to_end(void* bag);

  std::string path_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  Statement messages_;
  Statement bytes_;                      ///< holds the bytes of the last message given
  std::vector<RecordingItem> channels_;  ///< not yet given, in reverse order
  std::int64_t row_ = 0;
  double last_row_ = 0.0;
  int asked_ = 0;  ///< number of calls since a call of SQLite began
};

}  // namespace gdtslam
