// Every cut of a small log of every kind, at every byte: one stated outcome, within a second and 256 MB. The logs are
// written by our own writers, bags by that of the tests; what a cut may give follows from what the whole log gives.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bag_writer.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/logs/carmen.hpp"
#include "engine/io/recordings/recording_reader.hpp"
#include "engine/io/tables/table_reader.hpp"
#include "engine/io/writers/log_writer.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using OpenCut = std::function<std::unique_ptr<LogReader>(std::span<const std::byte>)>;

struct CutKind {
  std::string file;  ///< its ending tells the format
  std::optional<ChunkPacking> packing{};
  std::string warning;  ///< what a cut log is counted as
  /// Of text: how many lines are no records. A cut between two lines, or behind a whole one, cannot be seen there.
  std::optional<std::size_t> header_lines{};
  OpenCut open;
  std::string bag_packing{};  ///< of a bag's chunk
};

std::vector<CutKind> cut_kinds() {
  const OpenCut carmen = [](std::span<const std::byte> data) { return open_carmen(source_of(data), "cut", {}); };
  const OpenCut bag = [](std::span<const std::byte> data) { return open_bag(source_of(data), "cut", {}); };
  const OpenCut mcap = [](std::span<const std::byte> data) { return open_mcap(source_of(data), "cut", {}); };
  const auto table = [](TableKind kind) {
    return [kind](std::span<const std::byte> data) { return open_table(kind, source_of(data), "cut", {}); };
  };
  return {{"a.log", {}, "cut last line", 0, carmen},
          {"a.log.gz", {}, "gzip stream", {}, carmen},
          {"a.csv", {}, "cut last line", 1, table(TableKind::kCsv)},
          {"a.jsonl", {}, "cut last line", 0, table(TableKind::kJsonLines)},
          {"a.bag", {}, "cut bag", {}, bag, "none"},
          {"a.bag", {}, "cut bag", {}, bag, "lz4"},
          {"a.bag", {}, "cut bag", {}, bag, "bz2"},
          {"a.mcap", ChunkPacking::kNone, "cut bag", {}, mcap},
          {"a.mcap", ChunkPacking::kLz4, "cut bag", {}, mcap},
          {"a.mcap", ChunkPacking::kZstd, "cut bag", {}, mcap}};
}

std::string small_bag(const std::string& packing) {
  std::string records = test::bag_connection(0, "/scan", "sensor_msgs/LaserScan") +
                        test::bag_connection(1, "/odom", "nav_msgs/Odometry") +
                        test::bag_connection(2, "/tf_static", "tf2_msgs/TFMessage") +
                        test::bag_message(2, 10.0, test::ros_transform(10.0, "base_link", "laser", {.x_m = 0.5}));
  for (int k = 0; k < 4; ++k) {
    const double stamp_s = 10.0 + k;
    records += test::bag_message(1, stamp_s, test::ros_odometry(stamp_s, {.x_m = 0.25 * k, .y_m = 0.5})) +
               test::bag_message(0, stamp_s, test::ros_scan({.stamp_s = stamp_s}));
  }
  return test::bag_file(test::bag_chunk(records, packing));
}

std::string small_log(const CutKind& kind) {
  if (!kind.bag_packing.empty()) return small_bag(kind.bag_packing);
  const TemporaryFolder folder;
  AtomicFileSet files;
  const std::string path = folder / kind.file;
  const auto writer = make_log_writer(find_log_format(path, ""), path, kind.packing, files);
  for (int k = 0; k < 4; ++k) {
    const double stamp_s = 10.0 + k;
    const Pose2 pose{0.25 * k, 0.5, 0.125};
    writer->write(Odometry{.stamp_s = stamp_s, .T_odom_base = pose});
    ScanRecord record{.scan = {.stamp_s = stamp_s,
                               .first_bearing_rad = -1.0,
                               .bearing_step_rad = 0.5,
                               .max_range_m = 20.0,
                               .ranges_m = {1.0F, 2.5F, 3.25F, 4.5F},
                               .T_base_laser = Pose2{0.5, 0.0, 0.0}},
                      .T_odom_base = pose};
    writer->write(record);
  }
  writer->finish();
  files.commit();
  return get_file(path);
}

std::vector<double> scan_stamps(const WholeLog& log) {
  std::vector<double> stamps;
  for (const ScanRecord& record : log.of<ScanRecord>()) stamps.push_back(record.scan.stamp_s);
  return stamps;
}

/// Empty where the outcome is one of those that docs/formats.md states; `expected` are the scans of the whole log.
std::string fault_of_cut(const CutKind& kind, std::string_view cut, const std::vector<double>& expected) {
  try {
    const WholeLog log = drain(*kind.open(bytes_of(cut)));
    const std::vector<double> found = scan_stamps(log);
    if (found.size() > expected.size() || !std::equal(found.begin(), found.end(), expected.begin())) {
      return "gives scans that the whole log has not";
    }
    for (const LogReader::Warning& one : log.warnings) {
      if (one.count > 1 || (one.kind != kind.warning && one.kind != "cut last line"))
        return "has a warning " + one.kind;
    }
    if (log.warned(kind.warning) == 1 || found.size() == expected.size()) return "";
    if (!kind.header_lines) return "is short of scans without saying so";
    const auto lines = static_cast<std::size_t>(std::count(cut.begin(), cut.end(), '\n')) - *kind.header_lines;
    const std::size_t records = log.records.size();
    return records == lines + (cut.ends_with('\n') ? 0U : 1U) ? "" : "is short of records without saying so";
  } catch (const InputError& error) {
    const std::string_view what = error.what();
    return what.starts_with("cut") && what.find('\n') == std::string_view::npos ? "" : std::string(what);
  }
}

/// In a process of its own: 1 where a cut has no stated outcome or takes a second.
int try_each_cut(const CutKind& kind, const std::string& whole, const std::vector<double>& expected) {
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string cut = whole.substr(0, size);  // of its own, so that a sanitizer sees what is read behind it
    const std::clock_t start = std::clock();        // of the process, whatever else the machine does
    std::string fault = fault_of_cut(kind, cut, expected);
    if (fault.empty() && std::clock() - start > CLOCKS_PER_SEC) fault = "takes more than a second";
    if (fault.empty()) continue;
    std::fputs(fmt::format("{} cut after {} of {} bytes: {}\n", kind.file, size, whole.size(), fault).c_str(), stderr);
    return 1;
  }
  return 0;
}

TEST(EachCut, OfEveryKindOfLogHasOneStatedOutcome) {
  for (const CutKind& kind : cut_kinds()) {
    const std::string whole = small_log(kind);
    const WholeLog log = drain(*kind.open(bytes_of(whole)));
    const std::vector<double> expected = scan_stamps(log);
    ASSERT_THAT(expected, ::testing::ElementsAre(10.0, 11.0, 12.0, 13.0)) << kind.file;
    ASSERT_TRUE(log.warnings.empty()) << kind.file;
    const BoundedRun run = run_alone([&] { return try_each_cut(kind, whole, expected); });
    EXPECT_TRUE(run.exited) << kind.file;
    EXPECT_EQ(run.code, 0) << kind.file;
    if (!kIsInstrumented) {
      EXPECT_LT(run.peak_mb, 256.0) << kind.file;
    }
    RecordProperty(
        fmt::format("{}_{}{}", kind.file, kind.packing ? static_cast<int>(*kind.packing) : -1, kind.bag_packing),
        fmt::format("{} cuts in {:.1f} s, {:.0f} MB", whole.size(), run.cpu_s, run.peak_mb));
  }
}

}  // namespace
}  // namespace gdtslam
