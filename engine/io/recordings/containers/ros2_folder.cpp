#include "ros2_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/core/files/interruption.hpp"
#include "engine/core/files/retried.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/unpack_source.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "gdtslam/core/error.hpp"
#include "mcap.hpp"
#include "sqlite_bag.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 2> kFileEndings{".db3", ".mcap"};
constexpr std::array<std::string_view, 3> kPackedEndings{"", ".zstd", ".gz"};
constexpr std::size_t kMostFiles = 100'000;
constexpr std::size_t kMostHeadBytes = 16;

bool is_recording_name(std::string_view name) {
  for (const std::string_view packed : kPackedEndings) {
    for (const std::string_view ending : kFileEndings) {
      if (name.ends_with(std::string(ending) + std::string(packed))) return true;
    }
  }
  return false;
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::path& entry : list_folder(folder, error)) {
    std::string name = entry.filename().string();
    if (is_recording_name(name) && names.size() < kMostFiles) names.push_back(std::move(name));
  }
  if (error) throw FileError(folder, fmt::format("cannot be read: {}", error.message()));
  return names;
}

/// The names of files in metadata.yaml; empty without that file or names.
std::vector<std::string> names_in_metadata(const std::string& file) {
  std::vector<std::string> names;
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return names;
  const YAML::Node root = parse_yaml<InputError>(gdtslam::read_text<InputError>(file, kMaxYamlBytes), file);
  try {
    for (const YAML::Node& path : root["rosbag2_bagfile_information"]["relative_file_paths"]) {
      if (names.size() < kMostFiles) names.push_back(path.as<std::string>());
    }
  } catch (const YAML::Exception& error) {
    throw InputError({file, 0},
                     fmt::format("does not list the files of a ROS 2 bag ({})", one_line(error.what(), 200)));
  }
  return names;
}

/// A temporary file for the unpacked bytes of a source, within the bound on kept bytes (io/file_limits.hpp).
class SpooledFile {
 public:
  SpooledFile() : folder_(fs::temp_directory_path().string()), name_(folder_ + "/gdtslam-bag-XXXXXX") {
    descriptor_ = ::mkstemp(name_.data());
    if (descriptor_ < 0) fail();
  }
  SpooledFile(const SpooledFile&) = delete;
  SpooledFile& operator=(const SpooledFile&) = delete;
  ~SpooledFile() {
    ::unlink(name_.c_str());
    ::close(descriptor_);
  }
  [[nodiscard]] const std::string& name() const { return name_; }

  void fill(ByteSource& source, const std::string& name) {
    std::uint64_t bytes = 0;
    std::vector<char> piece(std::size_t{1} << 18U);
    while (const std::size_t count = source.read(piece)) {
      bytes += count;
      check_kept_bytes(bytes, source.bytes_from_file(), name);
      if (is_asked_to_end()) throw Error(ExitCode::kInterrupted, "interrupted while a bag was unpacked");
      if (!write_whole(descriptor_, {piece.data(), count})) fail();
    }
    if (const std::string defect = source.defect(); !defect.empty()) throw RecordingFault(defect);
  }

 private:
  [[noreturn]] void fail() const {
    const int why = errno;
    throw FileError(folder_,
                    fmt::format("cannot hold what a bag unpacks to: {}; TMPDIR names another folder", errno_text(why)));
  }
  std::string folder_;
  std::string name_;
  int descriptor_ = -1;
};

/// Orders channels by all their members.
struct ChannelOrder {
  bool operator()(const RecordingChannel& a, const RecordingChannel& b) const {
    const auto fields = [](const RecordingChannel& channel) {
      return std::tie(channel.topic, channel.type, channel.md5, channel.encoding_name, channel.encoding);
    };
    return fields(a) < fields(b);
  }
};

// The files of a folder in recording order.
std::vector<std::string> list_bag_files(const std::string& folder, const Recording::Warn& warn) {
  const std::vector<std::string> names = names_in(folder);
  std::vector<std::string> files;
  for (const std::string& stated : names_in_metadata((fs::path(folder) / "metadata.yaml").string())) {
    const std::string name =
        fs::path(stated).filename().string();  // early versions put the bag's name before the file's
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      warn("missing file of the bag", fmt::format("metadata.yaml names {}", in_quotes(stated)));
    } else if (std::find(files.begin(), files.end(), name) == files.end()) {
      files.push_back(name);
    }
  }
  if (files.empty() && names.size() == 1) files = names;
  if (files.empty() && !names.empty()) {
    throw InputError({folder, 0},
                     fmt::format("has {} files and no metadata.yaml that names them in their order; 'ros2 bag "
                                 "reindex' writes it, or give one file",
                                 names.size()));
  }
  if (files.empty()) {
    if (std::filesystem::exists(std::filesystem::path(folder) / "report.json")) {
      throw InputError({folder, 0}, "is a folder of results and no log; gdtslam map --continue maps its logs again");
    }
    throw InputError({folder, 0}, "is a folder without .db3 and .mcap files, so no ROS 2 bag");
  }
  return files;
}

/// Several files in sequence. Each has its own numbers of channels; equal channels get one number here, so that the
/// number of files is unlimited.
class FileSequence final : public Recording {
 public:
  explicit FileSequence(std::string folder) : folder_(std::move(folder)) {}

  std::optional<RecordingItem> next(const Wanted& wanted, const Warn& warn) override {
    if (!has_files_) files_ = list_bag_files(folder_, warn);
    has_files_ = true;
    while (true) {
      if (!file_ && !open_next()) return std::nullopt;
      std::optional<RecordingItem> item = next_of_file(wanted, warn);
      if (item) return item;
      leave_file(warn);
    }
  }

  [[nodiscard]] std::string place() const override {
    if (next_file_ == 0) return "before its first file";
    return fmt::format("in {} {}", in_quotes(files_[next_file_ - 1]), file_ ? file_->place() : "at its beginning");
  }

  [[nodiscard]] double progress() const override {
    if (files_.empty()) return -1.0;
    const double share = file_ ? std::max(0.0, file_->progress()) : 0.0;
    const std::size_t done = file_ ? next_file_ - 1 : next_file_;
    return (static_cast<double>(done) + share) / static_cast<double>(files_.size());
  }

 private:
  bool open_next() {
    if (next_file_ == files_.size()) return false;
    numbers_.clear();
    file_ = open_ros2_file((fs::path(folder_) / files_[next_file_++]).string());
    return true;
  }

  void leave_file(const Warn& warn) {
    if (const std::string defect = file_->defect(); !defect.empty()) warn("packed stream", defect);
    file_.reset();
  }

  std::optional<RecordingItem> next_of_file(const Wanted& wanted, const Warn& warn) {
    const auto find_number = [this](std::uint32_t channel) {
      const auto known = numbers_.find(channel);
      return known == numbers_.end() ? kNoChannel : known->second;
    };
    std::optional<RecordingItem> item =
        file_->next([&](std::uint32_t channel) { return wanted(find_number(channel)); }, warn);
    if (!item) return item;
    if (item->definition && !numbers_.contains(item->channel)) {
      numbers_.emplace(item->channel, number_over_files(*item->definition));
    }
    item->channel = find_number(item->channel);
    return item;
  }

  std::uint32_t number_over_files(const RecordingChannel& definition) {
    const auto known = known_.find(definition);
    if (known != known_.end()) return known->second;
    if (known_.size() >= kMostChannels) return kNoChannel;
    return known_.emplace(definition, static_cast<std::uint32_t>(known_.size())).first->second;
  }

  static constexpr std::uint32_t kNoChannel = 0xffffffffU;
  std::string folder_;
  std::vector<std::string> files_;
  bool has_files_ = false;
  std::size_t next_file_ = 0;
  std::unique_ptr<Recording> file_;
  std::map<std::uint32_t, std::uint32_t> numbers_;                 ///< numbers here by those of the current file
  std::map<RecordingChannel, std::uint32_t, ChannelOrder> known_;  ///< numbers over all files
};

}  // namespace

std::unique_ptr<Recording> open_ros2_file(const std::string& path) {
  const std::string packed_head = read_head(*open_file_source(path), kMostHeadBytes);
  if (packed_head.starts_with(kSqliteMagic)) return std::make_unique<SqliteBag>(path);
  std::unique_ptr<ByteSource> source = open_file_source(path);
  if (packed_head.starts_with(kZstdMagic)) {
    source = unpack_source(StreamPacking::kZstd, std::move(source), path);
  } else {
    source = gunzip_if_packed(std::move(source), path);
  }
  std::string head = read_head(*source, kMostHeadBytes);
  const bool is_sqlite = head.starts_with(kSqliteMagic);
  source = with_head(std::move(head), std::move(source));
  if (!is_sqlite) return std::make_unique<McapFile>(std::move(source));
  SpooledFile file;
  file.fill(*source, path);
  return std::make_unique<SqliteBag>(file.name());
}

std::unique_ptr<Recording> open_ros2_folder(const std::string& folder) {
  return std::make_unique<FileSequence>(folder);
}

}  // namespace gdtslam
