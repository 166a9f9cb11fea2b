// SIGINT, SIGTERM and SIGHUP as a flag that loops look at. The first signal lets the step in hand finish and ends the
// input of a program that waits for its standard input; a second SIGINT or SIGTERM ends the process. SIGPIPE and
// SIGXFSZ are ignored: a reader that goes away and a file that grows beyond its limit show as failed writes.
// Async-signal-safe.
#pragma once

namespace gdtslam {

/// Installs the handlers; call once, before any thread starts.
void install_interrupt_handlers();

/// True once one of the three came.
bool interrupted();

}  // namespace gdtslam
