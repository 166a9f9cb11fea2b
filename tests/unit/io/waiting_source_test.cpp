// Sources when somebody was asked after a signal whether their wait goes on: pipes end, files do not.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

#include "engine/core/files/interruption.hpp"
#include "engine/io/byte_source.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

std::string text_in(const std::string& path) { return read_all(*open_file_source(path), 100, path); }

TEST(AskedAfterSignals, TheInnermostAnswersUntilItGoes) {
  AskedAfterSignals::ask();
  EXPECT_FALSE(AskedAfterSignals::has_ended());
  int times = 0;
  const AskedAfterSignals outer([&times] { return ++times == 2; });
  AskedAfterSignals::ask();
  EXPECT_FALSE(AskedAfterSignals::has_ended());
  {
    const AskedAfterSignals inner([] { return true; });
    AskedAfterSignals::ask();
    EXPECT_TRUE(AskedAfterSignals::has_ended());
  }
  EXPECT_FALSE(AskedAfterSignals::has_ended());
  AskedAfterSignals::ask();
  EXPECT_TRUE(AskedAfterSignals::has_ended());
  AskedAfterSignals::ask();
  EXPECT_TRUE(AskedAfterSignals::has_ended()) << "whatever is answered later";
  EXPECT_EQ(times, 3);
}

TEST(AskedAfterSignals, FilesAreReadBehindTheEndAndPipesAreEmptyWithoutAWriter) {
  const TemporaryFolder folder;
  put_file(folder / "ten", "0123456789");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const AskedAfterSignals asked([] { return true; });
  AskedAfterSignals::ask();
  EXPECT_EQ(text_in(folder / "ten"), "0123456789");
  EXPECT_EQ(text_in(folder / "pipe"), "");
}

}  // namespace
}  // namespace gdtslam
