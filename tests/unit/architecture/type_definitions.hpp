// Which types a source file defines in named namespaces. A type that two files define under one name breaks the one
// definition rule even where no file sees both: the linker keeps either one's inline functions.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace gdtslam::architecture {

struct TypeDefinition {
  std::string name;  ///< with its namespaces and, of a specialization, its arguments: "gdtslam::Pose2"
  std::size_t line = 0;
};

/// Classes, structs, unions and enums of the text in the order of their lines. Those in anonymous namespaces, in other
/// types and in functions are left out.
std::vector<TypeDefinition> type_definitions(std::string_view text);

}  // namespace gdtslam::architecture
