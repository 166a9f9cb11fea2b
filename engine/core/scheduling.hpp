// How the system's scheduler is to treat a thread: hints, without which everything goes on as it is. A policy that the
// user gave the program (chrt) stays. Linux.
#pragma once

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>

namespace gdtslam {

/// For threads that work beside the one that somebody waits for. From now on this thread, and those that it starts,
/// wake up without taking the core from who is at work on it; their share of the time stays what it was.
inline void run_in_background() {
  if (::sched_getscheduler(0) != SCHED_OTHER) return;
  const sched_param no_priority{};
  static_cast<void>(::sched_setscheduler(0, SCHED_BATCH, &no_priority));
}

/// For threads that somebody waits for, who work a little and then sleep: this thread, and those that it starts, ask
/// for time in short pieces, and so get the core soon after they wake up. Linux from 6.12 on heeds it (EEVDF's slices).
inline void answer_promptly() {
  if (::sched_getscheduler(0) != SCHED_OTHER) return;
  struct Attributes {  // argument of sched_setattr(2), in its first version
    std::uint32_t size = sizeof(Attributes), policy = SCHED_OTHER;
    std::uint64_t flags = 0;
    std::int32_t nice = 0;
    std::uint32_t priority = 0;
    std::uint64_t runtime_ns = 500'000, deadline_ns = 0, period_ns = 0;
  };
  Attributes attributes;
  attributes.nice = ::getpriority(PRIO_PROCESS, 0);
  static_cast<void>(::syscall(SYS_sched_setattr, 0, &attributes, 0U));
}

}  // namespace gdtslam
