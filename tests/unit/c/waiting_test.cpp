// Logs that are pipes whose sender falls silent: a signal ends the wait where the caller wants it, and else nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/stat.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include "c_support.hpp"

namespace gdtslam::c {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// A signal every few milliseconds to this thread, whose handler does nothing, while the object lives.
class Signals {
 public:
  Signals() {
    struct sigaction action {};
    action.sa_handler = [](int) {};  // and no SA_RESTART
    ::sigaction(SIGUSR1, &action, &before_);
    thread_ = std::thread([this, target = ::pthread_self()] {
      while (!is_over_) {
        ::pthread_kill(target, SIGUSR1);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    });
  }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  ~Signals() {
    is_over_ = true;
    thread_.join();
    ::sigaction(SIGUSR1, &before_, nullptr);
  }

 private:
  std::atomic<bool> is_over_ = false;
  struct sigaction before_ {};
  std::thread thread_;
};

// What progress() was told, and what it says to it.
struct Caller {
  std::function<bool(std::uint64_t scans)> ends;
  std::atomic<int> asked = 0;
  std::uint64_t scans = 0;
  static std::int32_t progress(void* caller, const char* /*step*/, std::uint64_t scans, double /*share*/) {
    auto* const self = static_cast<Caller*>(caller);
    self->scans = scans;
    ++self->asked;
    return self->ends(scans) ? 1 : 0;
  }
};

class CWaiting : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const std::string& pipe : {pipe_, other_pipe_}) ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  }
  void TearDown() override {
    is_over_ = true;
    if (sender_.joinable()) sender_.join();
  }
  static std::string line(int number) {
    const std::string n = std::to_string(number);
    std::string text = "FLASER 30 ";
    for (int beam = 0; beam < 30; ++beam) text += std::to_string(2.0 + 0.01 * ((beam * 7) % 11)) + " ";
    return text + "0 0 0 0 0 0 " + n + ".0 host " + n + ".0\n";
  }
  // Gives so many scans, waits until it has been asked for, gives another and ends.
  void send(
      int scans, const std::function<bool()>& goes_on = [] { return false; }) {
    sender_ = std::thread([this, scans, goes_on] {
      std::ofstream pipe(pipe_);
      for (int k = 0; k < scans; ++k) pipe << line(k);
      pipe.flush();
      while (!is_over_ && !goes_on()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (!is_over_) pipe << line(scans);
    });
  }
  gdtslam_status open(Caller& caller) {
    const char* const log = pipe_.c_str();
    auto request = made<gdtslam_reader_request>();
    request.logs = &log;
    request.log_count = 1;
    request.progress = &Caller::progress;
    request.user_data = &caller;
    gdtslam_reader* reader = nullptr;
    const gdtslam_status status = gdtslam_reader_new(&request, &reader, &error_);
    reader_.reset(reader);
    return status;
  }
  gdtslam_status next() { return gdtslam_reader_next(reader_.get(), &scan_, &has_scan_, &error_); }
  gdtslam_status map_both(Caller& caller) {
    const std::array<const char*, 2> logs{pipe_.c_str(), other_pipe_.c_str()};
    auto request = made<gdtslam_map_request>();
    request.logs = logs.data();
    request.log_count = logs.size();
    request.folder = run_folder_.c_str();
    request.flags = GDTSLAM_NO_LOOPS | GDTSLAM_NO_PICTURES;
    request.progress = &Caller::progress;
    request.user_data = &caller;
    gdtslam_run* run = nullptr;
    const gdtslam_status status = gdtslam_map_logs(&request, &run, &error_);
    run_.reset(run);
    return status;
  }

  TempDir temp_;
  std::string pipe_ = (temp_.path() / "pipe").string();
  std::string other_pipe_ = (temp_.path() / "other").string();
  std::string run_folder_ = (temp_.path() / "run").string();
  gdtslam_error error_ = made<gdtslam_error>();
  gdtslam_scan scan_ = made<gdtslam_scan>();
  int32_t has_scan_ = 0;
  Owned<gdtslam_reader> reader_;
  Owned<gdtslam_run> run_;
  std::atomic<bool> is_over_ = false;
  std::thread sender_;
};

TEST_F(CWaiting, for_a_writer_ends_where_the_caller_wants) {
  Caller caller{.ends = [](std::uint64_t) { return true; }};
  const Signals signals;
  EXPECT_EQ(open(caller), GDTSLAM_INTERRUPTED);
  EXPECT_THAT(error_.text, HasSubstr("had no writer"));
  EXPECT_EQ(reader_, nullptr);
  EXPECT_EQ(map_both(caller), GDTSLAM_INTERRUPTED);
  EXPECT_EQ(run_, nullptr);
}

TEST_F(CWaiting, goes_on_where_the_caller_does_not_mind_the_signal) {
  Caller caller{.ends = [](std::uint64_t) { return false; }};
  const Signals signals;
  send(2, [&caller, before = 3] { return caller.asked > before; });
  ASSERT_EQ(open(caller), GDTSLAM_OK) << error_.text;
  for (int k = 0; k < 3; ++k) {
    ASSERT_EQ(next(), GDTSLAM_OK) << error_.text;
    EXPECT_EQ(scan_.stamp_s, k);
  }
  ASSERT_EQ(next(), GDTSLAM_OK) << error_.text;
  EXPECT_EQ(has_scan_, 0);
  EXPECT_GT(caller.asked, 3);
}

TEST_F(CWaiting, ends_for_good_where_the_caller_wants) {
  Caller caller{.ends = [](std::uint64_t scans) { return scans == 2; }};
  const Signals signals;
  send(2);
  ASSERT_EQ(open(caller), GDTSLAM_OK) << error_.text;
  for (int k = 0; k < 2; ++k) ASSERT_EQ(next(), GDTSLAM_OK) << error_.text;
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(next(), GDTSLAM_INTERRUPTED);
    EXPECT_EQ(has_scan_, 0);
    EXPECT_STREQ(error_.text, "interrupted while the log gave nothing; open it again");
  }
  EXPECT_EQ(caller.scans, 2U);
}

TEST_F(CWaiting, ends_for_good_where_the_caller_throws) {
  Caller caller{
      .ends = [](std::uint64_t scans) { return scans == 2 ? throw std::runtime_error("the caller") : false; }};
  const Signals signals;
  send(2);
  ASSERT_EQ(open(caller), GDTSLAM_OK) << error_.text;
  for (int k = 0; k < 2; ++k) ASSERT_EQ(next(), GDTSLAM_OK) << error_.text;
  EXPECT_EQ(next(), GDTSLAM_FAILED);
  EXPECT_STREQ(error_.text, "the caller");
  EXPECT_EQ(next(), GDTSLAM_INTERRUPTED);
}

// What comes behind the end is not waited for either.
TEST_F(CWaiting, ends_a_map_with_what_there_is) {
  constexpr std::uint64_t kSent = 30;
  Caller caller{.ends = [times = 0](std::uint64_t scans) mutable { return scans == kSent - 1 && ++times == 3; }};
  const Signals signals;
  send(kSent);
  EXPECT_EQ(map_both(caller), GDTSLAM_INTERRUPTED);
  EXPECT_THAT(error_.text, StartsWith("interrupted after 30 scans; their results are in "));
  ASSERT_NE(run_, nullptr);
  EXPECT_THAT(gdtslam_run_report(run_.get()), HasSubstr("\"interrupted\": true"));
  gdtslam_grid* field = nullptr;
  EXPECT_EQ(gdtslam_run_field(run_.get(), &field, &error_), GDTSLAM_OK) << error_.text;
  const Owned<gdtslam_grid> owned(field);
}

TEST_F(CWaiting, needs_a_log_and_flags_that_mean_something) {
  gdtslam_reader* reader = nullptr;
  auto request = made<gdtslam_reader_request>();
  EXPECT_EQ(gdtslam_reader_new(nullptr, &reader, &error_), GDTSLAM_USAGE);
  EXPECT_EQ(gdtslam_reader_new(&request, &reader, &error_), GDTSLAM_USAGE);
  EXPECT_STREQ(error_.text, "gdtslam_reader_new: logs is NULL");
  const char* const log = kSampleLog.c_str();
  request.logs = &log;
  EXPECT_EQ(gdtslam_reader_new(&request, &reader, &error_), GDTSLAM_USAGE);
  EXPECT_STREQ(error_.text, "gdtslam_reader_new: no log");
  request.log_count = 1;
  request.flags = GDTSLAM_NO_LOOPS;
  EXPECT_EQ(gdtslam_reader_new(&request, &reader, &error_), GDTSLAM_USAGE);
  request.flags = 0;
  request.reserved = 1;
  EXPECT_EQ(gdtslam_reader_new(&request, &reader, &error_), GDTSLAM_USAGE);
  request.reserved = 0;
  EXPECT_EQ(gdtslam_reader_new(&request, &reader, &error_), GDTSLAM_OK) << error_.text;
  gdtslam_reader_free(reader);
}

}  // namespace
}  // namespace gdtslam::c
