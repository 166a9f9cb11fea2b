// continue.json of a run: what it was asked for, so that it can be gone on with (docs/formats.md). Thread-safe;
// O(text).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gdtslam/runs/map_log.hpp"

namespace gdtslam {

/// In the folder of a run, and in its staging folder while it lasts.
inline constexpr const char* kContinueFile = "continue.json";

/// What a run knows before its first scan, for which it would have to look at its first log again.
struct RunPreparation {
  NodKind nods = NodKind::kNone;
  std::string linkage{};       ///< of a laser that nods: the preset or file that was taken
  std::string linkage_yaml{};  ///< and what it says
  std::optional<OdometryDelay> delay{};
  std::vector<LogFinding> findings{};
};

struct KeptRequest {
  MapRequest request;              ///< of what determines the result; the rest has its defaults
  std::vector<std::string> paths;  ///< of its logs, absolute
  std::optional<RunPreparation> prepared{};
};

/// What is kept of a request.
KeptRequest kept_request_of(const MapRequest& request);
/// The request with what was kept in place of its own: logs, configuration, range and parts.
MapRequest restored(const MapRequest& request, const KeptRequest& kept);

/// The log as it is found from any folder; "-" stays.
std::string absolute_path_of(const std::string& log);

/// Atomic. Throws FileError.
void write_continue_file(const std::string& file, const KeptRequest& kept);
/// Of the run in `folder`. Throws InputError or ConfigError where it is none of this version, FileError.
KeptRequest read_continue_file(const std::string& file, const std::string& folder);

}  // namespace gdtslam
