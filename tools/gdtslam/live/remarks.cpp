#include "remarks.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {

Remarks::Remarks(int descriptor)
    : output_({.most_waiting = LineOutput::Rule{}.most_waiting, .patience = kReaderPatience, .tries_each = true},
              descriptor) {
  try {
    output_.start();
  } catch (const std::system_error&) {  // there is no thread to be had: lines are printed as elsewhere
    return;
  }
  send_lines_to([this](std::string line) { output_.write(std::move(line)); });
}

Remarks::~Remarks() {
  send_lines_to({});
  try {
    output_.finish();
  } catch (const FileError&) {  // of which nobody can be told
  }
}

void print_remark_on_nods(const std::vector<LogReader::Warning>& warnings) {
  const bool nods = std::any_of(warnings.begin(), warnings.end(),
                                [](const auto& warning) { return warning.kind == ScanStream::kUnusedNods; });
  if (nods) print_remark("warning: the laser of this log nods, and live takes it for level; gdtslam map does not");
}

}  // namespace gdtslam
