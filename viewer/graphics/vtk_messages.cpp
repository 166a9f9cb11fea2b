#include "vtk_messages.hpp"

#include <vtkLogger.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>
#include <vtkTimerLog.h>

#include <mutex>
#include <sstream>
#include <utility>

namespace gdtslam {
namespace {

std::vector<std::string>& errors_of_this_thread() {
  thread_local std::vector<std::string> errors;
  return errors;
}

// "ERROR: In FILE, line 12 vtkClass (0x55d0): text" over several lines becomes one.
std::string one_line(const char* text) {
  std::istringstream words(text == nullptr ? "" : text);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

class Collector : public vtkOutputWindow {
 public:
  static Collector* New() {
    auto* collector = new Collector;
    collector->InitializeObjectBase();
    return collector;
  }
  void DisplayText(const char* /*text*/) override {}
  void DisplayErrorText(const char* text) override { errors_of_this_thread().push_back(one_line(text)); }
  void DisplayWarningText(const char* /*text*/) override {}
  void DisplayGenericWarningText(const char* /*text*/) override {}
  void DisplayDebugText(const char* /*text*/) override {}
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

std::vector<std::string> take_vtk_errors() { return std::exchange(errors_of_this_thread(), {}); }

}  // namespace gdtslam
