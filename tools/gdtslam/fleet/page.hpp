// The page of an atlas: one file that needs no server, with a card for each map. Its pictures lie in the run folders.
// Thread-safe; linear in the units, and a look for each thumbnail.
#pragma once

#include <string>

#include "engine/runs/fleet/summary.hpp"

namespace gdtslam {

/// `hash` is that of the atlas; empty where logs are missing. Texts of others are escaped.
std::string atlas_page(const std::string& atlas, const StoredPlan& stored, const AtlasState& state,
                       const AtlasSummary& summary, const std::string& hash);

}  // namespace gdtslam
