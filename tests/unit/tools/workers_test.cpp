// The processes that share work out.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "engine/core/memory/out_of_memory.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/workers.hpp"

namespace gdtslam {
namespace {

std::string result_of(Workers& workers) {
  for (;;) {
    const Workers::Event news = workers.wait();
    if (news.result) return *news.result;
  }
}

TEST(Workers, BringBackResultsWithTheirTimes) {
  Workers workers(2);
  EXPECT_TRUE(workers.is_idle());
  workers.start(7, [](const Workers::Tell&) { return std::string("line\nand \"share\" \xff"); });
  const Workers::Event news = [&] {
    for (;;) {
      const Workers::Event heard = workers.wait();
      if (heard.result) return heard;
    }
  }();
  EXPECT_EQ(news.id, 7U);
  EXPECT_EQ(*news.result, "line\nand \"share\" \xef\xbf\xbd");  // what is no UTF-8 becomes U+FFFD
  EXPECT_GE(news.cpu_s, 0.0);
  EXPECT_LT(news.cpu_s, 1.0);
  EXPECT_TRUE(workers.is_idle());
}

TEST(Workers, RunAtTheSameTimeInProcessesOfTheirOwn) {
  Workers workers(2);
  const auto pid = [](const Workers::Tell&) {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    return std::to_string(::getpid());
  };
  workers.start(0, pid);
  EXPECT_FALSE(workers.is_full());
  workers.start(1, pid);
  EXPECT_TRUE(workers.is_full());
  const std::string first = result_of(workers);
  const std::string second = result_of(workers);
  EXPECT_NE(first, second);
  EXPECT_NE(first, std::to_string(::getpid()));
}

TEST(Workers, TellHowFarTheyAre) {
  Workers workers(1);
  workers.start(0, [](const Workers::Tell& tell) {
    tell(0.25);
    return std::string();
  });
  const Workers::Event news = workers.wait();
  EXPECT_FALSE(news.result);
  EXPECT_DOUBLE_EQ(news.share, 0.25);
  EXPECT_EQ(result_of(workers), "");
}

TEST(Workers, ThrowWhatTheWorkThrew) {
  Workers workers(2);
  workers.start(0, [](const Workers::Tell&) -> std::string { throw FileError("there", "cannot be read"); });
  try {
    result_of(workers);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kInputOutput);
    EXPECT_STREQ(error.what(), "there: cannot be read");
  }
  EXPECT_TRUE(workers.is_idle());
}

TEST(Workers, SayThatMemoryIsShort) {
  Workers workers(1);
  workers.start(0, [](const Workers::Tell&) -> std::string { throw std::bad_alloc(); });
  try {
    result_of(workers);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kFailed);
    EXPECT_NE(std::string(error.what()).find("out of memory"), std::string::npos) << error.what();
  }
}

TEST(Workers, TellFailuresForMemoryFromOthers) {
  Workers workers(1);
  const auto is_for_memory = [&workers](const auto& problem) {
    workers.start(0, [&](const Workers::Tell&) -> std::string { throw problem; });
    for (;;) {
      if (const auto failure = workers.wait_for_any().failure) return failure->for_memory;
    }
  };
  EXPECT_TRUE(is_for_memory(OutOfMemory(8)));
  EXPECT_TRUE(is_for_memory(std::bad_alloc()));
  EXPECT_FALSE(is_for_memory(Error(ExitCode::kFailed, "else")));
}

TEST(Workers, SayWhichSignalEndedOne) {
  Workers workers(1);
  workers.start(0, [](const Workers::Tell&) -> std::string {
    ::raise(SIGKILL);
    return "";
  });
  try {
    result_of(workers);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kFailed);
    EXPECT_NE(std::string(error.what()).find("signal 9"), std::string::npos) << error.what();
  }
}

TEST(Workers, AreStoppedWithTheirOwner) {
  const auto begin = std::chrono::steady_clock::now();
  {
    Workers workers(1);
    workers.start(0, [](const Workers::Tell&) {
      ::signal(SIGTERM, SIG_DFL);
      std::this_thread::sleep_for(std::chrono::seconds(60));
      return std::string();
    });
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
}

}  // namespace
}  // namespace gdtslam
