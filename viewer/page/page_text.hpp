// The files of viewer/page as they were when the program was built. Thread-safe.
#pragma once

#include <string_view>

namespace gdtslam::page_text {

std::string_view skeleton();  ///< page.html with {{name}} where page_of fills in
std::string_view style();
std::string_view program();  ///< all scripts, one after the other

}  // namespace gdtslam::page_text
