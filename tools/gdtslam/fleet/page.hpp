// The page of an atlas: one file that needs no server, with a card for each map. Its pictures lie in the atlas.
// Thread-safe; linear in the logs, and a look for each picture.
#pragma once

#include <string>
#include <vector>

#include "engine/runs/fleet/atlas.hpp"

namespace gdtslam {

/// Texts of others are escaped.
std::string atlas_page(const std::string& atlas, const std::vector<FleetRecord>& records, const AtlasSummary& summary);

}  // namespace gdtslam
