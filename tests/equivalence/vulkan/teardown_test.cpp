// What validation says at the end of a backend, when nobody can be thrown to: it is handed out, or ends the process.
// The faults are made with the backend's own parts, since its verbs allow none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "engine/vulkan/engine.hpp"
#include "gdtslam/core/error.hpp"
#include "small_job.hpp"
#include "support/vulkan_device.hpp"

namespace gdtslam::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class Teardown : public testing::Test {
 protected:
  void SetUp() override {
    GDTSLAM_NEEDS_VULKAN();
    GDTSLAM_NEEDS_VALIDATION();
    options.index = find_test_device().device->index;
    options.validation = true;
    options.on_message = [this](std::string_view message) { messages.emplace_back(message); };
  }

  /// A backend's parts, on which `fault` is committed, and their end.
  template <class Fault>
  void end_after(Fault fault) {
    VulkanEngine engine(options);
    EXPECT_EQ(engine.log.take(), "");
    fault(engine);
  }

  VulkanOptions options;
  std::vector<std::string> messages;
};

void leak_a_buffer(VulkanEngine& engine) {
  const vk::BufferCreateInfo info({}, 64, vk::BufferUsageFlagBits::eStorageBuffer);
  static_cast<void>(vk::raii::Buffer(engine.device.handle(), info).release());
}

void set_to_work(VulkanEngine& engine) {
  const std::uint64_t id = engine.buffers.create(64);
  engine.transfers.fill(engine.buffers.at(id), 1);
  engine.batches.submit();
}

/// Nobody asks whether the device is done, which to validation is destroying what is in use. In truth it is done by
/// then: else a CPU that plays a device would write into memory that is gone.
void destroy_a_buffer_in_flight(VulkanEngine& engine) {
  set_to_work(engine);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
}

TEST_F(Teardown, SaysNothingOfWhatGoesInOrder) {
  end_after([](VulkanEngine& engine) {
    set_to_work(engine);
    engine.batches.wait_for(engine.batches.submitted());
  });
  EXPECT_THAT(messages, IsEmpty());
}

TEST_F(Teardown, HandsOutThatAnObjectWasLeaked) {
  end_after(leak_a_buffer);
  EXPECT_THAT(messages, Contains(HasSubstr("VUID-vkDestroyDevice-device-00378")));
}

TEST_F(Teardown, HandsOutThatABufferWasDestroyedInFlight) {
  end_after(destroy_a_buffer_in_flight);
  EXPECT_THAT(messages, Contains(HasSubstr("VUID-vkDestroyBuffer-buffer-00922")));
}

TEST_F(Teardown, OfABackendThatWorksHasNothingToSay) {
  {
    const auto backend = make_vulkan_backend(options);
    const Buffer global = new_map(*backend);
    run_job(*backend, 3);
    record_job(*backend, global, 1);
    const PendingDownload unfinished = backend->start_download(global, 64);
    backend->flush();
    record_job(*backend, global, 2);  // recorded, never submitted
  }
  EXPECT_THAT(messages, IsEmpty());
}

TEST_F(Teardown, OfABackendThatFailedHasNothingToSay) {
  for (options.lost_at = 1; options.lost_at < 30; ++options.lost_at) {
    try {
      run_job(*make_vulkan_backend(options), 2);
    } catch (const DeviceError& error) {
      EXPECT_NE(error.call(), "validation") << error.what();
    }
  }
  EXPECT_THAT(messages, IsEmpty());
}

using TeardownDeath = Teardown;

TEST_F(TeardownDeath, WithoutAListenerEndsTheProcess) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  options.on_message = {};
  EXPECT_DEATH(end_after(leak_a_buffer), "validation at the end of a backend gave .*VUID-vkDestroyDevice");
}

}  // namespace
}  // namespace gdtslam::test
