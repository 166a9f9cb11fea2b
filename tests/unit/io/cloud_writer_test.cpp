#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

#include "engine/io/sha256.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const CloudPoint kPoint{
    .x_m = 1.5F, .y_m = -2.0F, .z_m = 0.25F, .elevation_rad = 0.5F, .stamp_s = 976052857.25, .scan = 7};

void write(const std::string& path, CloudFormat format, const Cloud& cloud) {
  CloudWriter writer(path, format);
  writer.add(cloud);
  writer.finish();
}

// By hand from IEEE 754 and the formats' descriptions.
TEST(CloudWriter, WritesTheseBytes) {
  const TemporaryFolder folder;
  const std::string binary("\0\0\xc0\x3f\0\0\0\xc0\0\0\x80\x3e\0\0\0\x3f\0\0\xa0\x3c\xb1\x16\xcd\x41\x07\0\0\0", 28);
  write(folder / "c.ply", CloudFormat::kPlyBinary, {kPoint});
  const std::string ply = get_file(folder / "c.ply");
  EXPECT_TRUE(ply.starts_with("ply\nformat binary_little_endian 1.0\ncomment "));
  EXPECT_TRUE(
      ply.ends_with("element vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                    "property float elevation\nproperty double time\nproperty uint scan\nend_header\n" +
                    binary));
  write(folder / "c.pcd", CloudFormat::kPcdBinary, {kPoint});
  EXPECT_TRUE(get_file(folder / "c.pcd").ends_with("POINTS 1\nDATA binary\n" + binary));
  CloudWriter writer(folder / "b.ply", CloudFormat::kPlyBinary);
  writer.add(Cloud{kPoint});
  writer.finish();
  EXPECT_EQ(writer.points_sha256(), Sha256().update(binary).hex());
}

TEST(CloudWriter, WithoutFinishTheOldFileStaysAndNothingElse) {
  const TemporaryFolder folder;
  put_file(folder / "c.ply", "old");
  {
    CloudWriter writer(folder / "c.ply", CloudFormat::kPlyBinary);
    writer.add(Cloud(100000, kPoint));
  }
  EXPECT_EQ(get_file(folder / "c.ply"), "old");
  EXPECT_THAT(folder.names(), ElementsAre("c.ply"));
}

TEST(CloudWriter, FullDiskIsAFileErrorAndTheOldFileStays) {
  for (const rlim_t room : {rlim_t{100}, rlim_t{1000000}}) {  // in finish(), in add()
    const TemporaryFolder folder;
    put_file(folder / "c.ply", "old");
    const BoundedRun run = run_alone([&] {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{room, room};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      try {
        write(folder / "c.ply", CloudFormat::kPlyBinary, Cloud(room == 100 ? 10 : 100000, kPoint));
      } catch (const FileError& error) {
        return std::string(error.what()).find("c.ply: cannot be written") != std::string::npos ? 74 : 1;
      }
      return 0;
    });
    EXPECT_EQ(run.code, 74);
    EXPECT_EQ(get_file(folder / "c.ply"), "old");
    EXPECT_THAT(folder.names(), ElementsAre("c.ply"));
  }
}

TEST(CloudWriter, PipesAreRefusedBeforeAnythingIsWritten) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const auto refusal = [](const std::string& path) {
    try {
      const CloudWriter writer(path, CloudFormat::kPlyBinary);
    } catch (const FileError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(refusal(folder / "pipe"), HasSubstr("pipe: is a pipe or a device"));
  EXPECT_THROW(CloudWriter(folder.path().string(), CloudFormat::kPlyBinary), FileError);
}

TEST(CloudWriter, TheNameTellsTheFormat) {
  EXPECT_EQ(find_cloud_format("a/b.ply"), CloudFormat::kPlyBinary);
  EXPECT_EQ(find_cloud_format("B.PCD"), CloudFormat::kPcdBinary);
  EXPECT_THROW(find_cloud_format("ply"), UsageError);
  EXPECT_THROW(find_cloud_format("a.ply.gz"), UsageError);
}

}  // namespace
}  // namespace gdtslam
