// What a MemoryReserve lends is told by the handler that operator new calls where it has nothing: the standard has it
// ask again where the handler returns, and end by what it throws (C++20, [new.delete.single]).
#include "viewer/graphics/memory_reserve.hpp"

#include <gtest/gtest.h>

#include <new>
#include <thread>

namespace gdtslam {
namespace {

TEST(MemoryReserve, LendsOnceAndTells) {
  const std::new_handler before = std::get_new_handler();
  {
    const MemoryReserve reserve;
    EXPECT_NO_THROW(reserve.throw_where_memory_ended());
    const std::new_handler handler = std::get_new_handler();
    ASSERT_NE(handler, nullptr);
    EXPECT_NO_THROW(handler()) << "the first time there is something to lend";
    EXPECT_THROW(reserve.throw_where_memory_ended(), std::bad_alloc);
    EXPECT_THROW(handler(), std::bad_alloc) << "and then no more";
    const MemoryReserve later;
    EXPECT_NO_THROW(later.throw_where_memory_ended()) << "what failed before is not its matter";
    EXPECT_NO_THROW(handler()) << "it was filled again";
    EXPECT_THROW(later.throw_where_memory_ended(), std::bad_alloc);
  }
  EXPECT_EQ(std::get_new_handler(), before);
}

TEST(MemoryReserve, IsSharedByThreads) {
  const std::new_handler before = std::get_new_handler();
  {
    const MemoryReserve first;
    std::thread([&] {
      const MemoryReserve second;
      EXPECT_NO_THROW(std::get_new_handler()());
      EXPECT_THROW(second.throw_where_memory_ended(), std::bad_alloc);
    }).join();
    EXPECT_NE(std::get_new_handler(), before) << "the other one is still there";
    EXPECT_THROW(first.throw_where_memory_ended(), std::bad_alloc);
  }
  EXPECT_EQ(std::get_new_handler(), before);
}

}  // namespace
}  // namespace gdtslam
