// A folder that takes its name as a whole: what becomes of the old one, of what lies there, and of what a killed
// process left.
#include "engine/runs/transaction/folder_transaction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "engine/runs/folder/run_folder.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

void write_text(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

std::string text_in(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

template <class Act>
std::string fault_of_folder(const Act& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

class FolderTransactionTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(base_); }
  void TearDown() override { fs::remove_all(base_); }
  void put_run() const {
    RunFolder run(run_.string());
    write_text(run.staged("map.pgm"), "old");
    write_text(run.staged("report.json"), R"({"format": 1, "map_sha256": "", "files": [["map.pgm", 3, ""]]})");
    run.commit();
  }

  const fs::path base_ =
      fs::canonical(fs::temp_directory_path()) / ("gdtslam-transaction-" + std::to_string(::getpid()));
  const fs::path run_ = base_ / "run";
  const fs::path staging_ = base_ / ".run.gdtslam-new";
};

TEST_F(FolderTransactionTest, ReplacesTheWholeFolder) {
  fs::create_directories(run_);
  write_text(run_ / "old", "old");
  FolderTransaction made(run_.string());
  EXPECT_EQ(made.staging(), staging_);
  write_text(made.staging() / "new", "new");
  EXPECT_THAT(names_in(run_), ElementsAre("old"));
  made.commit();
  EXPECT_THAT(names_in(run_), ElementsAre("new"));
  EXPECT_THAT(names_in(base_), ElementsAre("run"));
}

TEST_F(FolderTransactionTest, WithoutACommitNothingChanges) {
  fs::create_directories(run_);
  write_text(run_ / "old", "old");
  { write_text(FolderTransaction(run_.string()).staging() / "new", "new"); }
  EXPECT_THAT(names_in(run_), ElementsAre("old"));
  EXPECT_THAT(names_in(base_), ElementsAre("run"));
  { const FolderTransaction made((base_ / "a/b/run").string()); }
  EXPECT_THAT(names_in(base_), ElementsAre("run")) << "folders above it stay";
}

TEST_F(FolderTransactionTest, ALinkStaysAndItsTargetIsReplaced) {
  fs::create_directories(run_);
  fs::create_directory_symlink("run", base_ / "link");
  FolderTransaction made((base_ / "link/").string());
  write_text(made.staging() / "new", "new");
  made.commit();
  EXPECT_TRUE(fs::is_symlink(base_ / "link"));
  EXPECT_THAT(names_in(run_), ElementsAre("new"));
}

TEST_F(FolderTransactionTest, NothingElseOfThatNameIsTaken) {
  fs::create_directories(base_ / "precious");
  write_text(base_ / "precious/file", "mine");
  fs::create_directory_symlink("precious", staging_);
  EXPECT_THAT(fault_of_folder([&] { const FolderTransaction made(run_.string()); }),
              HasSubstr("something else has that name"));
  EXPECT_EQ(text_in(base_ / "precious/file"), "mine");
  fs::remove(staging_);
  fs::create_directories(base_ / ".run.gdtslam-new-old");
  FolderTransaction made(run_.string());
  made.commit();
  EXPECT_TRUE(fs::exists(base_ / ".run.gdtslam-new-old"));
}

TEST_F(FolderTransactionTest, TheModeOfTheOldFolderStays) {
  fs::create_directories(run_);
  fs::permissions(run_, fs::perms::owner_all);
  FolderTransaction made(run_.string());
  made.commit();
  EXPECT_EQ(fs::status(run_).permissions(), fs::perms::owner_all);
}

TEST_F(FolderTransactionTest, WhatCannotBeExchangedIsRefused) {
  EXPECT_THAT(fault_of_folder([] { const FolderTransaction made("."); }), HasSubstr("is the working folder"));
  EXPECT_THAT(fault_of_folder([] { const FolderTransaction made("/proc"); }), HasSubstr("is a mount point"));
  write_text(base_ / "file", "mine");
  EXPECT_THAT(fault_of_folder([&] { const FolderTransaction made((base_ / "file").string()); }),
              HasSubstr("Not a directory"));
  EXPECT_EQ(text_in(base_ / "file"), "mine");
}

TEST_F(FolderTransactionTest, ARunReplacesARunAndNothingElse) {
  put_run();
  EXPECT_NO_THROW(put_run()) << "of its own files only";
  write_text(run_ / "notes.txt", "mine");
  EXPECT_THAT(fault_of_folder([&] { put_run(); }), HasSubstr("holds a notes.txt that no run wrote"));
  EXPECT_EQ(text_in(run_ / "notes.txt"), "mine");
  fs::create_directory(run_ / "photos");
  const auto replace = [&] { RunFolder(run_.string(), true).commit(); };
  EXPECT_THAT(fault_of_folder(replace), HasSubstr("holds a folder photos that no run wrote"));
  fs::remove(run_ / "photos");
  replace();
  EXPECT_THAT(names_in(run_), IsEmpty());
}

TEST_F(FolderTransactionTest, FilesOfARunWithoutAReportAreOfSomebodyElse) {
  for (const char* name : {"map.yaml", "map.pgm", "report.json", "merge.json", "notes.txt"}) {
    fs::create_directories(run_);
    write_text(run_ / name, "{}");
    EXPECT_THAT(fault_of_folder([&] { const RunFolder run(run_.string()); }), HasSubstr("that no run wrote")) << name;
    fs::remove_all(run_);
  }
}

TEST_F(FolderTransactionTest, AFileThatComesMeanwhileStays) {
  put_run();
  RunFolder run(run_.string());
  write_text(run.staged("map.pgm"), "new");
  write_text(run_ / "notes.txt", "mine");
  EXPECT_THROW(run.commit(), UsageError);
  EXPECT_EQ(text_in(run_ / "notes.txt"), "mine");
  EXPECT_EQ(text_in(run_ / "map.pgm"), "old");
}

}  // namespace
}  // namespace gdtslam
