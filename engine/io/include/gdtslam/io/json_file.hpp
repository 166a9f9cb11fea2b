// JSON files by nlohmann-json; the one public header of io that names it, so that only who writes JSON needs it.
// Thread-safe; O(text).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace gdtslam {

/// Indented by two, numbers in the shortest form that reads back as the same bits, not-finite ones as null, text that
/// is no UTF-8 with replacement characters; ends in a newline.
std::string json_text(const nlohmann::ordered_json& value);
/// Atomic. Throws FileError.
void write_json(const std::string& path, const nlohmann::ordered_json& value);

}  // namespace gdtslam
