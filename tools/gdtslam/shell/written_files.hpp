// Files that a command is told to write, checked before its work begins: a run of minutes should not end with "cannot
// be created", and none should replace what it reads. Thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

/// Nothing where `file` is empty. Throws UsageError that names the option where `file` is one of `inputs` under
/// whatever name, FileError where its folder does not exist.
void check_written_file(std::string_view option, const std::string& file, const std::vector<std::string>& inputs);

}  // namespace gdtslam
