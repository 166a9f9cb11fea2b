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

Workers::Event next_end(Workers& workers) {
  for (;;) {
    const Workers::Event event = workers.wait_for_any();
    if (event.result || event.failure) return event;
  }
}

TEST(Workers, BringBackResultsWithTheirTimes) {
  Workers workers(2);
  EXPECT_TRUE(workers.is_idle());
  workers.start(7, [](const Workers::Tell&) { return std::string("line\nand \"share\" \xff"); });
  const Workers::Event news = next_end(workers);
  EXPECT_EQ(news.id, 7U);
  EXPECT_EQ(*news.result, "line\nand \"share\" \xef\xbf\xbd");  // what is no UTF-8 becomes U+FFFD
  EXPECT_GE(news.cpu_s, 0.0);
  EXPECT_LT(news.cpu_s, 1.0);
  EXPECT_TRUE(workers.is_idle());
}

TEST(Workers, ThrowWhatTheWorkThrew) {
  Workers workers(2);
  workers.start(0, [](const Workers::Tell&) -> std::string { throw FileError("there", "cannot be read"); });
  const Workers::Event end = next_end(workers);
  ASSERT_TRUE(end.failure);
  EXPECT_EQ(end.failure->code, ExitCode::kInputOutput);
  EXPECT_EQ(end.failure->message, "there: cannot be read");
  EXPECT_TRUE(workers.is_idle());
}

TEST(Workers, TellFailuresForMemoryFromOthers) {
  Workers workers(1);
  const auto is_for_memory = [&workers](const auto& problem) {
    workers.start(0, [&](const Workers::Tell&) -> std::string { throw problem; });
    return next_end(workers).failure->for_memory;
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
  const Workers::Event end = next_end(workers);
  ASSERT_TRUE(end.failure);
  EXPECT_TRUE(end.failure->by_signal);
  EXPECT_NE(end.failure->message.find("signal 9"), std::string::npos) << end.failure->message;
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
