// A trajectory held against relations that somebody verified.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {

struct RelationCheck {
  std::vector<Relation> relations;  ///< whose stamps tell which poses are meant
  RelationReport report;            ///< on these
};

/// `name` is what the trajectory is of. Throws InputError at `name` where the stamps of all relations occur twice, at
/// `relations_file` where the trajectory has those of none.
RelationCheck check_relations(const Trajectory& trajectory, std::span<const Relation> given,
                              const std::string& relations_file, const std::string& name, double tolerance_s = 1e-4);

}  // namespace gdtslam
