// What an atlas has come to: counts, reasons, the slowest, shard by shard; atlas.json and summary.csv. Thread-safe.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "state.hpp"

namespace gdtslam {

struct AtlasCounts {
  std::size_t units = 0;
  std::size_t mapped = 0;
  std::size_t refused = 0;
  [[nodiscard]] std::size_t missing() const { return units - mapped - refused; }
};

struct AtlasSummary {
  AtlasCounts counts;
  std::vector<AtlasCounts> shards;
  std::map<std::string, std::size_t> reasons;  ///< of refused logs, numbers in them left out, and how often
  std::vector<std::size_t> slowest;            ///< units by CPU time, at most ten
  std::map<std::string, std::size_t> hosts;    ///< units that each did
  std::uint64_t scans = 0;
  double path_m = 0.0;
  double log_duration_s = 0.0;
  double cpu_s = 0.0;
  double wall_s = 0.0;
};
AtlasSummary summary_of(const StoredPlan& stored, const AtlasState& state);

/// A reason without what differs from log to log: each number is N.
std::string kind_of_reason(std::string_view reason);

/// What `fleet status --json` prints.
nlohmann::ordered_json status_json(const StoredPlan& stored, const AtlasState& state, const AtlasSummary& summary);

/// atlas.json; its atlas_sha256 is null where units are missing.
nlohmann::ordered_json atlas_json(const StoredPlan& stored, const AtlasState& state, const AtlasSummary& summary);

/// A line a unit, by URI, with a header; RFC 4180.
std::string summary_csv(const StoredPlan& stored, const AtlasState& state);

}  // namespace gdtslam
