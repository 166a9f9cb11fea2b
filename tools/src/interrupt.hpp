// SIGINT and SIGTERM as a flag that loops look at. The first signal lets the step in hand finish and ends the input of
// a program that waits for its standard input; a second one ends the process. SIGPIPE is ignored: a reader that goes
// away shows as a failed write. Async-signal-safe.
#pragma once

namespace gdtslam {

/// Installs the handlers; call once, before any thread starts.
void install_interrupt_handlers();

/// True once SIGINT or SIGTERM came.
bool interrupted();

}  // namespace gdtslam
