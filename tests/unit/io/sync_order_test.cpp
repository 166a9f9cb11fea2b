// docs/formats.md: everything is written to a temporary name in the same folder, synced and renamed, and then the
// folder is synced. A call that is left out loses nothing until the power fails, so the calls themselves are looked at.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "engine/io/atomic_file.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"
#include "support/recorded_calls.hpp"

namespace gdtslam {
namespace {

using test::RecordedCalls;
using testing::ElementsAre;

TEST(SyncOrder, AFileIsOnTheDiskBeforeItTakesItsNameAndThenItsFolderIs) {
  const TemporaryFolder folder;
  const RecordedCalls calls(folder / "");
  write_file_atomically(folder / "a.txt", "new");
  EXPECT_THAT(calls.all(), ElementsAre("sync ~", "rename ~ to a.txt", "sync ."));
}

TEST(SyncOrder, OfASetAllAreOnTheDiskBeforeTheFirstTakesItsName) {
  const TemporaryFolder folder;
  put_file(folder / "a", "old");
  const RecordedCalls calls(folder / "");
  AtomicFileSet files;
  files.add(folder / "a").write("new a");
  files.add(folder / "b").write("new b");
  files.commit();
  const std::vector<std::string> made = calls.all();
  std::size_t synced = 0;
  std::size_t named = 0;
  for (const std::string& call : made) {
    if (call == "sync ~") {
      EXPECT_EQ(named, 0U) << "a name before all is on the disk";
      ++synced;
    }
    if (call.find(" to ") != std::string::npos) ++named;
  }
  EXPECT_EQ(synced, 2U);
  EXPECT_GE(named, 2U);
  EXPECT_EQ(made.back(), "sync .");
}

}  // namespace
}  // namespace gdtslam
