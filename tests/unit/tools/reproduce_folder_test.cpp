// Folders of `gdtslam reproduce` beside those of its user: which go and which stay. And a part in its folder that
// somebody changed.
#include "tools/lab/reproduce/store.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "gdtslam/core/error.hpp"
#include "tools/lab/reproduce/drives.hpp"

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

TEST_F(ReproduceFolders, OfAllDrivesGoesWhereItIsOursAndNothingElseIsInIt) {
  const Drives drives(in("work"), "program", {}, {});
  fs::create_directory(in("work"));
  drives.prepare();
  drives.clear();
  EXPECT_TRUE(fs::exists(in("work"))) << "an empty folder of somebody else";
  fs::remove(in("work"));
  drives.clear();  // nothing there: nothing to do
  drives.prepare();
  make_marked_folder(in("work/drive"));
  write("work/file", "precious");
  drives.clear();
  EXPECT_FALSE(fs::exists(in("work/drive")));
  EXPECT_EQ(text("work/file"), "precious");
  fs::remove(in("work/file"));
  drives.clear();
  EXPECT_FALSE(fs::exists(in("work")));
}

TEST_F(ReproduceFolders, APartWithANumberThatThereIsNotCountsAsNotMade) {
  Store store(in("report"));
  KeptPart kept;
  kept.part.state("width", "", "1 cm", "");
  const auto find_with = [&](const std::string& entry, const std::string& changed) {
    store.begin("fig3");
    store.keep("fig3", "key", kept);
    std::string json = text("report/parts/fig3/part.json");
    const std::size_t at = json.find(entry);
    EXPECT_NE(at, std::string::npos) << json;
    write("report/parts/fig3/part.json", json.replace(at, entry.size(), changed));
    return store.find("fig3", "key").has_value();
  };
  EXPECT_TRUE(find_with("\"verdict\": 2", "\"verdict\": 1"));
  for (const char* const number : {"3", "-1", "256", "1.0"})
    EXPECT_FALSE(find_with("\"verdict\": 2", "\"verdict\": " + std::string(number))) << number;
  for (const char* const number : {"3", "-1", "257", "18446744073709551617"})
    EXPECT_FALSE(find_with("\"origin\": 1", "\"origin\": " + std::string(number))) << number;
}

}  // namespace
}  // namespace gdtslam::reproduce
