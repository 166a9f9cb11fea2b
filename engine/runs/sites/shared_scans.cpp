#include "shared_scans.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

namespace gdtslam {
namespace {

struct OwnedScan {
  const LaserScan* laser = nullptr;
  std::size_t run = 0;
};

bool come_before(const OwnedScan& a, const OwnedScan& b) {
  if (a.laser->stamp_s != b.laser->stamp_s) return a.laser->stamp_s < b.laser->stamp_s;
  if (a.run != b.run) return a.run < b.run;
  return a.laser->ranges_m < b.laser->ranges_m;
}

bool has_return(const LaserScan& laser) {
  return std::any_of(laser.ranges_m.begin(), laser.ranges_m.end(),
                     [](float range_m) { return std::isfinite(range_m); });
}

// What merges and edits take out is a beam without return; no reading is ever another one, and most are still there.
bool are_one_scan(const LaserScan& a, const LaserScan& b) {
  if (a.ranges_m.size() != b.ranges_m.size()) return false;
  std::size_t common = 0;
  std::size_t taken_out = 0;
  for (std::size_t beam = 0; beam < a.ranges_m.size(); ++beam) {
    const bool is_in_a = std::isfinite(a.ranges_m[beam]);
    const bool is_in_b = std::isfinite(b.ranges_m[beam]);
    if (is_in_a != is_in_b) ++taken_out;
    if (!is_in_a || !is_in_b) continue;
    if (a.ranges_m[beam] != b.ranges_m[beam]) return false;
    ++common;
  }
  return common > taken_out;
}

// Those with returns by stamp, of each run by its own; one that a log repeats is there once.
std::vector<OwnedScan> all_scans(const std::vector<const RunKeyframes*>& runs) {
  std::vector<OwnedScan> scans;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    for (const RunKeyframe& keyframe : runs[run]->keyframes) {
      if (has_return(keyframe.laser)) scans.push_back({&keyframe.laser, run});
    }
  }
  std::sort(scans.begin(), scans.end(), come_before);
  const auto repeats = [](const OwnedScan& a, const OwnedScan& b) { return !come_before(a, b) && !come_before(b, a); };
  scans.erase(std::unique(scans.begin(), scans.end(), repeats), scans.end());
  return scans;
}

using Counts = std::map<std::pair<std::size_t, std::size_t>, std::size_t>;

// Of scans with one stamp: how many of a run's are in a later run.
void count_shared(std::span<const OwnedScan> scans, Counts& counts) {
  for (std::size_t i = 0; i < scans.size(); ++i) {
    std::size_t last = scans[i].run;
    for (std::size_t k = i + 1; k < scans.size(); ++k) {
      if (scans[k].run == last || !are_one_scan(*scans[i].laser, *scans[k].laser)) continue;
      last = scans[k].run;
      ++counts[{scans[i].run, last}];
    }
  }
}

}  // namespace

std::vector<SharedScans> shared_scans(const std::vector<const RunKeyframes*>& runs) {
  const std::vector<OwnedScan> scans = all_scans(runs);
  Counts counts;
  for (auto begin = scans.begin(); begin != scans.end();) {
    const double stamp_s = begin->laser->stamp_s;
    const auto end = std::find_if(begin, scans.end(), [&](const OwnedScan& s) { return s.laser->stamp_s != stamp_s; });
    count_shared({begin, end}, counts);
    begin = end;
  }
  std::vector<SharedScans> shared;
  shared.reserve(counts.size());
  for (const auto& [pair, count] : counts) shared.push_back({pair.first, pair.second, count});
  return shared;
}

}  // namespace gdtslam
