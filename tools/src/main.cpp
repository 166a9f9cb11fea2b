#include "command_line.hpp"
#include "interrupt.hpp"

int main(int argc, char** argv) {
  gdtslam::install_interrupt_handlers();
  return gdtslam::run_command_line(argc, argv);
}
