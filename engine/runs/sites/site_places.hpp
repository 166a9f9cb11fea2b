// Where a merge may write its sites: folders 1, 2 and so on of the results. What it would replace there is a site of an
// earlier merge, which can be made again, and never a run, whose copy of its log may be the only one. Thread-safe.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gdtslam {

/// Pictures of what changed in a site, one of them where it changed.
std::vector<std::string> names_of_changes();

/// Whether a merge wrote that folder, by what its report tells: it has the paths of its drives, and was not edited
/// since. A link to one is none.
bool is_site(const std::string& folder);

/// Folders of sites of an earlier merge with higher numbers than `sites`, by name.
std::vector<std::string> sites_beyond(const std::string& folder, std::size_t sites);

/// Throws UsageError where a place of a site holds something else, or a run to be joined is the folder of the results
/// or lies at such a place; before anything is written, and as if no run were joined with another. `replaces_foreign`:
/// a run or file that is none of those to be joined is replaced.
void require_places_of_sites(const std::string& folder, std::span<const std::string> runs, bool replaces_foreign);

}  // namespace gdtslam
