#include "linkage_sidecar.hpp"

#include <filesystem>
#include <string_view>
#include <system_error>

namespace gdtslam {

std::string sidecar_path(const std::string& log, const std::string& suffix) {
  std::string_view stem = log;
  for (const std::string_view ending : {".gz", ".log", ".clf"}) {
    if (stem.ends_with(ending)) stem.remove_suffix(ending.size());
  }
  return std::string(stem) + suffix;
}

std::string linkage_sidecar(const std::string& log) {
  if (log == "-") return {};
  std::string path = sidecar_path(log, ".linkage.yaml");
  std::error_code none;  // what cannot be looked at is not there
  return std::filesystem::is_regular_file(path, none) ? path : std::string();
}

}  // namespace gdtslam
