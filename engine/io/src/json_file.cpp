#include "gdtslam/io/json_file.hpp"

#include <nlohmann/json.hpp>

#include "gdtslam/io/atomic_file.hpp"

namespace gdtslam {

std::string json_text(const nlohmann::ordered_json& value) {
  return value.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void write_json(const std::string& path, const nlohmann::ordered_json& value) {
  write_file_atomically(path, json_text(value));
}

}  // namespace gdtslam
