// Rules about folders: which room of a part may include private headers of which other room, how many sources a folder
// may hold, and how many public headers there are. docs/architecture.md draws the house.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "source_rules.hpp"

namespace gdtslam::architecture {

/// More sources than this in one folder are two rooms.
inline constexpr std::size_t kMostSources = 25;
/// What all libraries show together.
inline constexpr std::size_t kMostPublicHeaders = 65;

using Arrows = std::map<std::string, std::set<std::string, std::less<>>, std::less<>>;

/// For each room of a part with several: the rooms of the same part whose private headers it may include. Public
/// headers are everybody's.
const Arrows& room_arrows();

/// The folder of a source as the table names it: "engine/mapping/match", "tools/gdtslam/map".
std::string room_of(std::string_view path);

/// Private headers of another room of the same part that the table does not allow.
std::vector<Violation> room_violations(std::string_view path, std::string_view text);

/// A way through the arrows that comes back to where it began; empty where all arrows run down.
std::vector<std::string> circle_in(const Arrows& arrows);

}  // namespace gdtslam::architecture
