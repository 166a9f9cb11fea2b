#include "graphics/vtk_messages.hpp"

#include <vtkLogger.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <mutex>
#include <utility>

namespace gdtslam {
namespace {

VtkMessages& of_this_thread() {
  thread_local VtkMessages messages;
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
  return line;
}

class Collector : public vtkOutputWindow {
 public:
  static Collector* New() {
    auto* collector = new Collector;
    collector->InitializeObjectBase();
    return collector;
  }
  void DisplayText(const char* text) override { of_this_thread().warnings.push_back(one_line(text)); }
  void DisplayErrorText(const char* text) override { of_this_thread().errors.push_back(one_line(text)); }
  void DisplayWarningText(const char* text) override { of_this_thread().warnings.push_back(one_line(text)); }
  void DisplayGenericWarningText(const char* text) override { of_this_thread().warnings.push_back(one_line(text)); }
  void DisplayDebugText(const char* /*text*/) override {}
};
}  // namespace

void collect_vtk_messages() {
  static std::once_flag once;
  std::call_once(once, [] {
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    const auto collector = vtkSmartPointer<Collector>::New();
    vtkOutputWindow::SetInstance(collector);
  });
}

VtkMessages take_vtk_messages() { return std::exchange(of_this_thread(), {}); }

}  // namespace gdtslam
