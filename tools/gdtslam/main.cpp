#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"

int main(int argc, char** argv) {
  gdtslam::hold_standard_streams();
  gdtslam::install_interrupt_handlers();
  return gdtslam::run_command_line(argc, argv, gdtslam::command_program(), gdtslam::build_stamp());
}
