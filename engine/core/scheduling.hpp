// Hints to the system's scheduler about threads; everything also works without them. A policy that the user set for the
// program (chrt) stays. Linux.
#pragma once

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>

namespace gdtslam {

/// For background threads: from now on this thread, and threads that it starts, do not preempt a running thread when
/// they wake up. Their share of the time stays the same.
inline void run_in_background() {
  if (::sched_getscheduler(0) != SCHED_OTHER) return;
  const sched_param no_priority{};
  static_cast<void>(::sched_setscheduler(0, SCHED_BATCH, &no_priority));
}

/// For threads that work briefly and then sleep while somebody waits for them: this thread, and threads that it starts,
/// request short time slices and so get the core soon after they wake up. Supported from Linux 6.12 on (EEVDF's
/// slices).
inline void answer_promptly() {
  if (::sched_getscheduler(0) != SCHED_OTHER) return;
  struct Attributes {  // argument of sched_setattr(2), first version
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
