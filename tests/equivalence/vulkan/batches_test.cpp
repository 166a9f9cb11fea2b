// When work starts, how often something is submitted, what is ordered by barriers, and what becomes of memory that is
// released while the device works.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "gdtslam/core/error.hpp"
#include "small_job.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

class Batches : public testing::Test {
 protected:
  void SetUp() override {
    GDTSLAM_NEEDS_VULKAN();
    backend = test_backend();
  }
  std::unique_ptr<VulkanBackend> backend;
};

TEST_F(Batches, NothingRecordedIsNothingSubmitted) {
  backend->flush();
  backend->flush();
  EXPECT_EQ(backend->submit_count(), 0U);
  const Buffer unused = backend->allocate(100);
  backend->upload(unused, {}, 100);
  std::vector<std::byte> nothing;
  backend->download(unused, nothing, 100);
  EXPECT_EQ(backend->dispatch_count(), 0U);
}

TEST_F(Batches, WhatLiesBetweenTwoFlushesIsOneSubmission) {
  const Buffer global = new_map(*backend);
  record_job(*backend, global, 1);
  record_job(*backend, global, 2);
  EXPECT_EQ(backend->submit_count(), 0U);
  backend->flush();
  EXPECT_EQ(backend->submit_count(), 1U);
  record_job(*backend, global, 3);
  std::vector<std::byte> found(64);
  const PendingDownload download = backend->start_download(global, 64, 0);
  EXPECT_EQ(backend->submit_count(), 1U);
  backend->finish_download(download, found);
  EXPECT_EQ(backend->submit_count(), 2U);
  backend->flush();
  EXPECT_EQ(backend->submit_count(), 2U);
  EXPECT_EQ(backend->dispatch_count(), 12U);
}

TEST_F(Batches, AFinishedDownloadDoesNotStartWhatCameLater) {
  const Buffer global = new_map(*backend);
  std::vector<std::byte> found(64);
  const PendingDownload download = backend->start_download(global, 64, 0);
  backend->flush();
  record_job(*backend, global, 1);
  backend->finish_download(download, found);
  EXPECT_EQ(backend->submit_count(), 1U);
}

TEST_F(Batches, ManyBatchesGiveTheMapOfTheCpu) {
  const auto cpu = make_cpu_backend({});
  const auto expected = run_job(*cpu, 60);
  EXPECT_EQ(run_job(*backend, 60), expected);
  EXPECT_EQ(backend->submit_count(), 31U);  // each second round, and the download
  EXPECT_EQ(backend->dispatch_count(), 240U);
}

TEST_F(Batches, TwoBackendsWorkSideBySide) {
  const auto other = test_backend();
  const Buffer here = new_map(*backend);
  const Buffer there = new_map(*other);
  for (std::uint64_t round = 1; round < 9; ++round) {
    record_job(*backend, here, round);
    record_job(*other, there, round);
    (round % 2 == 0 ? *backend : *other).flush();
  }
  std::vector<std::byte> a(here.bytes());
  std::vector<std::byte> b(there.bytes());
  backend->download(here, a);
  other->download(there, b);
  EXPECT_EQ(a, b);
  EXPECT_THROW(other->download(here, a), Error);
}

TEST_F(Batches, MemoryThatIsReleasedInFlightIsNotGivenAwayTooEarly) {
  constexpr std::uint32_t kSide = 512;
  const auto seeds = make_seeds(SeedPattern::kOne, kSide, kSide, kSide, 1);
  const JumpFloodInit::Params params{.width = kSide, .height = kSide, .stride = kSide};
  const auto cpu = make_cpu_backend({});
  const auto distances = [&](Backend& device) {
    const Buffer nearest = device.allocate(4 * seeds.size());
    {
      const Buffer input = device.allocate(seeds.size());
      device.upload(input, std::as_bytes(std::span(seeds)));
      run<JumpFloodInit>(device, params, {kSide, kSide, 1}, input, nearest);
      device.flush();
    }  // the device may still read the input
    for (int i = 0; i < 3; ++i) {
      const Buffer next = device.allocate(seeds.size());
      device.fill(next, 0x01010101U);
      device.flush();
    }
    std::vector<std::byte> found(nearest.bytes());
    device.download(nearest, found);
    return found;
  };
  EXPECT_TRUE(distances(*backend) == distances(*cpu));
}

TEST_F(Batches, ABufferMayGoBeforeItsBatchIsSubmitted) {
  const auto cpu = make_cpu_backend({});
  const auto expected = run_job(*cpu, 3);
  for (int round = 0; round < 20; ++round) {  // record_job releases its buffers before anything is submitted
    EXPECT_EQ(run_job(*backend, 3), expected) << round;
  }
}

TEST_F(Batches, MemoryOfManyBuffersIsUsedAgain) {
  // Twice what the device has, in all; so most of it has to come back.
  const std::size_t bytes = backend->device().max_buffer_bytes / 2;
  const std::size_t rounds = backend->vulkan_device().memory_bytes / bytes * 2;
  for (std::size_t round = 0; round < rounds; ++round) {
    const Buffer buffer = backend->allocate(bytes);
    backend->upload(buffer, std::vector<std::byte>(16, std::byte{1}), 0);
    backend->flush();
  }
  const Buffer last = backend->allocate(16);
  std::vector<std::byte> found(16, std::byte{9});
  backend->download(last, found);
  EXPECT_EQ(found, std::vector<std::byte>(16));
}

TEST_F(Batches, BarriersFollowFromTheBindings) {
  const std::uint32_t stride = grid_stride(kJobWidth);
  const std::size_t cells = std::size_t{stride} * kJobHeight;
  const Buffer seeds = backend->allocate(cells);
  const Buffer a = backend->allocate(cells * 4);
  const Buffer b = backend->allocate(cells * 4);
  const Buffer squares = backend->allocate(cells * 2);
  const Buffer field = backend->allocate(cells * 2);
  for (const Buffer* buffer : {&seeds, &a, &b, &squares, &field}) {
    backend->fill(*buffer, 0);
  }
  const Extent all{kJobWidth, kJobHeight, 1};
  const GdtMerge::Params merge{
      .scan_width = kJobWidth, .scan_height = kJobHeight, .scan_stride = stride, .global_stride = stride, .cap = 5120};
  const auto barriers_of = [&](auto action) {
    const std::uint64_t before = backend->work().barriers;
    action();
    return backend->work().barriers - before;
  };
  const auto begin_flood = [&](const Buffer& to) {
    run<JumpFloodInit>(*backend, {kJobWidth, kJobHeight, stride}, all, seeds, to);
  };
  const auto squares_of = [&](const Buffer& from) {
    run<JumpFloodDistance>(*backend, {kJobWidth, kJobHeight, stride, kJobRadius}, all, from, squares);
  };
  const auto merge_once = [&] { run<GdtMerge>(*backend, merge, all, field, squares); };
  EXPECT_EQ(backend->work().barriers, 0U);                       // five buffers that do not touch each other
  EXPECT_EQ(barriers_of([&] { begin_flood(a); }), 1U);           // fill, then read
  EXPECT_EQ(barriers_of([&] { begin_flood(b); }), 0U);           // two readers
  EXPECT_EQ(barriers_of([&] { begin_flood(b); }), 1U);           // write, then write
  EXPECT_EQ(barriers_of([&] { squares_of(a); }), 0U);            // covered by it
  EXPECT_EQ(barriers_of([&] { begin_flood(a); }), 1U);           // read, then write
  EXPECT_EQ(barriers_of(merge_once), 0U);                        // the squares were written before that barrier
  EXPECT_EQ(barriers_of(merge_once), 1U);                        // read and written, again
  EXPECT_EQ(barriers_of([&] { backend->fill(field, 0); }), 1U);  // read and written, then copied to
  EXPECT_EQ(barriers_of([&] { backend->fill(seeds, 0); }), 0U);  // read before the last barrier
  EXPECT_EQ(barriers_of([&] { backend->flush(); }), 0U);
  EXPECT_EQ(barriers_of([&] { begin_flood(b); }), 1U);  // what the batch before wrote
}

TEST_F(Batches, LaunchesAreRefusedWithTheWordsOfTheCpu) {
  const auto cpu = make_cpu_backend({});
  const auto refusal = [](Backend& device, auto action) -> std::string {
    const Buffer seeds = device.allocate(640);
    const Buffer distance = device.allocate(2560);
    try {
      action(device, seeds, distance);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  const auto expect_alike = [&](auto action) {
    const std::string expected = refusal(*cpu, action);
    EXPECT_NE(expected, "no error");
    EXPECT_EQ(refusal(*backend, action), expected);
  };
  const JumpFloodInit::Params good{.width = 60, .height = 10, .stride = 64};
  const auto with = [&](auto member, std::uint32_t value, Extent threads) {
    JumpFloodInit::Params params = good;
    params.*member = value;
    expect_alike([=](Backend& device, const Buffer& seeds, const Buffer& distance) {
      run<JumpFloodInit>(device, params, threads, seeds, distance);
    });
  };
  with(&JumpFloodInit::Params::height, 11, {60, 11, 1});
  with(&JumpFloodInit::Params::stride, 62, {60, 10, 1});
  with(&JumpFloodInit::Params::stride, 64, {59, 10, 1});
  expect_alike([=](Backend& device, const Buffer& seeds, const Buffer&) {
    run<JumpFloodInit>(device, good, {60, 10, 1}, seeds, seeds);
  });
  expect_alike([=](Backend& device, const Buffer& seeds, const Buffer&) {
    run<JumpFloodInit>(device, good, {60, 10, 1}, seeds, Buffer{});
  });
  expect_alike([=](Backend& device, const Buffer& seeds, const Buffer&) {
    const Buffer* const one[] = {&seeds};
    device.dispatch(JumpFloodInit::info(), one, std::as_bytes(std::span(&good, 1)), {60, 10, 1});
  });
  EXPECT_EQ(backend->dispatch_count(), 0U);
}

TEST_F(Batches, AnEmptyLaunchIsCountedAndDoesNothing) {
  const Buffer seeds = backend->allocate(640);
  const Buffer distance = backend->allocate(2560);
  run<JumpFloodInit>(*backend, {.width = 0, .height = 0, .stride = 0}, {0, 0, 1}, seeds, distance);
  EXPECT_EQ(backend->dispatch_count(), 1U);
  backend->flush();
  EXPECT_EQ(backend->submit_count(), 0U);
}

TEST_F(Batches, ManyBuffersAreBoundAtATime) {
  constexpr std::size_t kBuffers = 300;  // more descriptor sets than a pool holds
  constexpr std::uint32_t kSide = 32;
  const JumpFloodInit::Params params{.width = kSide, .height = kSide, .stride = kSide};
  const auto cpu = make_cpu_backend({});
  const auto distances = [&](Backend& device) {
    std::vector<Buffer> inputs;
    std::vector<Buffer> outputs;
    for (std::size_t i = 0; i < kBuffers; ++i) {
      const auto seeds = make_seeds(SeedPattern::kSparse, kSide, kSide, kSide, i);
      inputs.push_back(device.allocate(seeds.size()));
      outputs.push_back(device.allocate(4 * seeds.size()));
      device.upload(inputs.back(), std::as_bytes(std::span(seeds)));
    }
    for (int again = 0; again < 2; ++again) {
      for (std::size_t i = 0; i < kBuffers; ++i) {
        run<JumpFloodInit>(device, params, {kSide, kSide, 1}, inputs[i], outputs[i]);
      }
    }
    constexpr std::size_t kBytes = 4 * kSide * kSide;
    std::vector<std::byte> all(kBuffers * kBytes);
    for (std::size_t i = 0; i < kBuffers; ++i) {
      device.download(outputs[i], std::span(all).subspan(i * kBytes, kBytes));
    }
    return all;
  };
  EXPECT_TRUE(distances(*backend) == distances(*cpu));
}

TEST_F(Batches, BuffersMayOutliveTheirBackend) {
  Buffer buffer = backend->allocate(100);
  backend->fill(buffer, 1);
  backend->flush();
  backend.reset();
  EXPECT_FALSE(buffer.valid());
  buffer = Buffer{};
}

}  // namespace
}  // namespace gdtslam::test
