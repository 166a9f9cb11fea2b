#include "known_relations.hpp"

#include <fmt/format.h>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

RelationCheck check_relations(const Trajectory& trajectory, std::span<const Relation> given,
                              const std::string& relations_file, const std::string& name, double tolerance_s) {
  RelationCheck check{.relations = without_repeated_stamps(given, trajectory, tolerance_s), .report = {}};
  if (!given.empty() && check.relations.empty()) {
    throw InputError(
        {name, 0},
        fmt::format("has the stamps of all {} relations twice, a clock stepped back: cut it there", given.size()));
  }
  check.report = evaluate_relations(trajectory, check.relations, tolerance_s);
  if (check.report.all.translation_m.count > 0) return check;
  throw InputError({relations_file, 0},
                   fmt::format("none of its {} relations has stamps of {}; do both belong to the same log?",
                               check.relations.size(), name));
}

}  // namespace gdtslam
