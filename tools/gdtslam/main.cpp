#include "tools/gdtslam/shell/command_line.hpp"
#include "tools/gdtslam/shell/interrupt.hpp"

int main(int argc, char** argv) {
  gdtslam::install_interrupt_handlers();
  return gdtslam::run_command_line(argc, argv, gdtslam::command_table());
}
