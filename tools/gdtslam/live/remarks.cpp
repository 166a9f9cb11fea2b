#include "remarks.hpp"

#include <system_error>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {

Remarks::Remarks(int descriptor)
    : output_({.most_waiting = LineOutput::Rule{}.most_waiting, .patience = kReaderPatience}, descriptor) {
  send_lines_to([this](std::string line) {
    try {
      output_.write(std::move(line));
    } catch (const std::system_error&) {  // there is no thread to be had: the line waits for the next one
    }
  });
}

Remarks::~Remarks() {
  send_lines_to({});
  try {
    output_.finish();
  } catch (const FileError&) {  // of which nobody can be told
  }
}

}  // namespace gdtslam
