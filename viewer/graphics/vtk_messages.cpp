#include "vtk_messages.hpp"

#include <vtkLogger.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>
#include <vtkTimerLog.h>

#include <algorithm>
#include <mutex>
#include <utility>

namespace gdtslam {
namespace {

struct Messages {
  std::vector<std::string> errors;
  std::vector<std::string> warnings;
};

Messages& of_this_thread() {
  thread_local Messages messages;
  return messages;
}

std::string one_line(const char* text) {
  std::string line;
  for (const char* c = text; c != nullptr && *c != '\0'; ++c) {
    const bool is_space = *c == '\n' || *c == '\r' || *c == '\t' || *c == ' ';
    if (!is_space) {
      line += *c;
    } else if (!line.empty() && line.back() != ' ') {
      line += ' ';
    }
  }
  if (!line.empty() && line.back() == ' ') line.pop_back();
  // "ERROR: In FILE, line 12 vtkClass (0x55d0): text": of this the class and the text.
  const std::size_t address = line.find(" (0x");
  const std::size_t text_start = line.find("): ", address);
  if (address == std::string::npos || text_start == std::string::npos) return line;
  const std::size_t before_class = line.rfind(' ', address - 1);
  return line.substr(before_class + 1, address - before_class - 1) + ": " + line.substr(text_start + 3);
}

class Collector : public vtkOutputWindow {
 public:
  static Collector* New() {
    auto* collector = new Collector;
    collector->InitializeObjectBase();
    return collector;
  }
  void DisplayText(const char* text) override { warn(text); }
  void DisplayErrorText(const char* text) override { of_this_thread().errors.push_back(one_line(text)); }
  void DisplayWarningText(const char* text) override { warn(text); }
  void DisplayGenericWarningText(const char* text) override { warn(text); }
  void DisplayDebugText(const char* /*text*/) override {}

 private:
  // The same warning comes with every frame of a film.
  static void warn(const char* text) {
    std::vector<std::string>& warnings = of_this_thread().warnings;
    std::string line = one_line(text);
    if (std::find(warnings.begin(), warnings.end(), line) == warnings.end()) warnings.push_back(std::move(line));
  }
};

}  // namespace

void collect_vtk_messages() {
  static std::once_flag once;
  std::call_once(once, [] {
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    const auto collector = vtkSmartPointer<Collector>::New();
    vtkOutputWindow::SetInstance(collector);
    vtkTimerLog::LoggingOff();  // VTK keeps one log of its events for all threads that draw, without a lock
  });
}

std::vector<std::string> take_vtk_errors() { return std::exchange(of_this_thread().errors, {}); }

std::vector<std::string> take_vtk_warnings() { return std::exchange(of_this_thread().warnings, {}); }

}  // namespace gdtslam
