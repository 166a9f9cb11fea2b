#include "remarks.hpp"

#include <system_error>
#include <utility>

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

}  // namespace gdtslam
