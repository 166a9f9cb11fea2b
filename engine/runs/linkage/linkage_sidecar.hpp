// The linkage file that lies beside a log: what `simulate` writes and `map` finds.
#pragma once

#include <string>

namespace gdtslam {

/// LOG without .gz, .log and .clf, with `suffix`: the name of a file that belongs to a log.
std::string sidecar_path(const std::string& log, const std::string& suffix);
/// sidecar_path(log, ".linkage.yaml") where that file exists; empty where not, and for the standard input.
std::string linkage_sidecar(const std::string& log);

}  // namespace gdtslam
