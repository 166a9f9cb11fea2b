// What has to be known of a YAML text before yaml-cpp may load it. Thread-safe; linear.
#pragma once

#include <string>
#include <string_view>

namespace gdtslam {

/// yaml-cpp descends once per nested bracket or indent, so depth is bounded first: no file of ours is nested deeper
/// than 32 brackets or indented by more than 256 blanks.
bool is_nested_too_deep(std::string_view text);

/// True when something follows the first document. (YAML::LoadAll would tell, but never returns from some faulty
/// texts.) Throws what yaml-cpp throws for a text that is no YAML.
bool goes_on_after_its_document(const std::string& text);

}  // namespace gdtslam
