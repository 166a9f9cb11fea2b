// The fuzzers' corpus, replayed with every compiler; each file must end in a record or a typed error.
#include <algorithm>

#include "fuzz/targets.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using Target = void (*)(std::span<const std::byte>);

void replay(const std::string& corpus, Target target, std::size_t fewest_files) {
  const std::filesystem::path folder = std::filesystem::path(GDTSLAM_SOURCE_DIR) / "tests/fuzz/corpus" / corpus;
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().string());
    const std::string text = get_file(entry.path().string());
    EXPECT_NO_THROW(target(bytes_of(text)));
    ++files;
  }
  EXPECT_GE(files, fewest_files);
}

TEST(FuzzCorpus, Carmen) { replay("carmen", fuzz::read_carmen, 12); }
TEST(FuzzCorpus, Bag) { replay("bag", fuzz::read_bag, 14); }
TEST(FuzzCorpus, Mcap) { replay("mcap", fuzz::read_mcap, 5); }
TEST(FuzzCorpus, SqliteBag) { replay("sqlite_bag", fuzz::read_sqlite_bag, 2); }
TEST(FuzzCorpus, Cdr) { replay("cdr", fuzz::read_cdr, 6); }
TEST(FuzzCorpus, Csv) { replay("csv", fuzz::read_csv, 6); }
TEST(FuzzCorpus, JsonLines) { replay("jsonl", fuzz::read_json_lines, 5); }
TEST(FuzzCorpus, LogCopy) { replay("log_copy", fuzz::read_log_copy, 6); }
TEST(FuzzCorpus, Config) { replay("config", fuzz::read_config, 8); }
TEST(FuzzCorpus, Map) { replay("map", fuzz::read_map_image, 3); }
TEST(FuzzCorpus, Tum) { replay("tum", fuzz::read_trajectory, 2); }
TEST(FuzzCorpus, Ply) { replay("ply", fuzz::read_cloud_file, 5); }
TEST(FuzzCorpus, Pcd) { replay("pcd", fuzz::read_cloud_file, 5); }
TEST(FuzzCorpus, Mesh) { replay("mesh", fuzz::read_mesh_file, 8); }
TEST(FuzzCorpus, Png) { replay("png", fuzz::read_distance_image, 2); }

}  // namespace
}  // namespace gdtslam
