// A ROS 2 bag as rosbag2 stores it with SQLite: NAME/NAME_0.db3 with NAME/metadata.yaml (version 5, that of Humble,
// which later ones read), or a database by itself. Messages are in CDR. Memory is that of SQLite's page cache, 2 MiB.
// One object belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "ros_container.hpp"

struct sqlite3;       // of SQLite
struct sqlite3_stmt;  // likewise

namespace gdtslam {

inline constexpr const char* kRos2Metadata = "metadata.yaml";
/// The database of a bag in that folder.
std::string ros2_database_of(std::string folder);

class Ros2DatabaseWriter final : public RosContainer {
 public:
  /// `path` is the folder, which is made, or the database. Throws FileError, as all members do.
  Ros2DatabaseWriter(const std::string& path, AtomicFileSet& files, bool has_folder);
  [[nodiscard]] RosEncoding encoding() const override { return RosEncoding::kCdr; }
  std::uint32_t add_channel(const std::string& topic, RosType type, bool is_latched) override;
  void add(std::uint32_t channel, std::int64_t received_ns, std::string_view message) override;
  void finish() override;
  [[nodiscard]] std::uint64_t bytes() const override { return bytes_; }

 private:
  struct CloseDatabase {
    void operator()(sqlite3* database) const;
  };
  struct FreeStatement {
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, FreeStatement>;
  struct Topic {
    std::string name;
    std::string type;
    std::string quality;
    std::uint64_t messages = 0;
  };
  void run(const std::string& commands);
  Statement prepared(const std::string& command);
  void step(sqlite3_stmt* statement);
  void check(int status) const;
  [[nodiscard]] std::string metadata() const;

  std::string database_name_;  ///< without its folder
  AtomicFile* file_ = nullptr;
  AtomicFile* metadata_ = nullptr;  ///< none for a database by itself
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  Statement insert_;
  std::vector<Topic> topics_;
  std::uint64_t bytes_ = 0;  ///< of messages
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::uint64_t messages_ = 0;
};

}  // namespace gdtslam
