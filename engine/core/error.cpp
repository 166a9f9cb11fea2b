#include "gdtslam/core/error.hpp"

namespace gdtslam {

std::string located(const FilePosition& position, const std::string& message) {
  if (position.line == 0) {
    return position.file + ": " + message;
  }
  return position.file + ":" + std::to_string(position.line) + ": " + message;
}

}  // namespace gdtslam
