// Folders of `gdtslam reproduce` beside those of its user: which go and which stay.
#include "tools/lab/reproduce/store.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam::reproduce {
namespace {

namespace fs = std::filesystem;

class ReproduceFolders : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(base_); }
  void TearDown() override { fs::remove_all(base_); }
  [[nodiscard]] std::string in(const std::string& name) const { return (base_ / name).string(); }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((base_ / name).parent_path());
    std::ofstream(base_ / name) << text;
  }
  [[nodiscard]] std::string text(const std::string& name) const {
    std::ifstream file(base_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  fs::path base_ = fs::temp_directory_path() / ("gdtslam-reproduce-" + std::to_string(::getpid()));
};

TEST_F(ReproduceFolders, OfOthersStay) {
  write("theirs/file", "precious");
  fs::create_directory_symlink(base_ / "theirs", base_ / "link");
  write("plain", "precious");
  make_marked_folder(in("ours"));
  for (const char* const name : {"theirs", "link", "plain"}) {
    EXPECT_THROW(require_own_folder(in(name)), FileError) << name;
    EXPECT_THROW(remove_own_folder(in(name)), FileError) << name;
    EXPECT_THROW(make_marked_folder(in(name)), FileError) << name;
    EXPECT_THROW(replace_own_folder(in("ours"), in(name)), FileError) << name;
  }
  EXPECT_EQ(text("theirs/file") + text("link/file") + text("plain"), "preciouspreciousprecious");
  EXPECT_TRUE(is_marked_folder(in("ours")));
}

TEST_F(ReproduceFolders, OfOursGoAndAreReplaced) {
  make_marked_folder(in("new"));
  write("new/file", "new");
  replace_own_folder(in("new"), in("part"));
  EXPECT_EQ(text("part/file"), "new");
  make_marked_folder(in("new"));
  write("new/file", "newer");
  replace_own_folder(in("new"), in("part"));
  EXPECT_EQ(text("part/file"), "newer");
  EXPECT_FALSE(fs::exists(in("new")));
  remove_own_folder(in("part"));
  EXPECT_FALSE(fs::exists(in("part")));
  remove_own_folder(in("part"));  // nothing there: nothing to do
}

}  // namespace
}  // namespace gdtslam::reproduce
