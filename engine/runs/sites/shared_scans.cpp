#include "shared_scans.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

namespace gdtslam {
namespace {

struct OwnedScan {
  const LaserScan* laser = nullptr;
  std::size_t run = 0;
};

bool come_before(const OwnedScan& a, const OwnedScan& b) {
  if (a.laser->stamp_s != b.laser->stamp_s) return a.laser->stamp_s < b.laser->stamp_s;
  return a.laser->ranges_m < b.laser->ranges_m;
}

bool are_one_scan(const OwnedScan& a, const OwnedScan& b) { return !come_before(a, b) && !come_before(b, a); }

std::vector<OwnedScan> all_scans(const std::vector<const RunKeyframes*>& runs) {
  std::vector<OwnedScan> scans;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    for (const RunKeyframe& keyframe : runs[run]->keyframes) scans.push_back({&keyframe.laser, run});
  }
  std::sort(scans.begin(), scans.end(), come_before);
  return scans;
}

}  // namespace

std::vector<SharedScans> shared_scans(const std::vector<const RunKeyframes*>& runs) {
  const std::vector<OwnedScan> scans = all_scans(runs);
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> counts;
  for (auto begin = scans.begin(); begin != scans.end();) {
    const auto end = std::find_if_not(begin, scans.end(), [&](const OwnedScan& s) { return are_one_scan(*begin, s); });
    std::set<std::size_t> owners;
    for (auto scan = begin; scan != end; ++scan) owners.insert(scan->run);
    for (auto first = owners.begin(); first != owners.end(); ++first) {
      for (auto second = std::next(first); second != owners.end(); ++second) ++counts[{*first, *second}];
    }
    begin = end;
  }
  std::vector<SharedScans> shared;
  shared.reserve(counts.size());
  for (const auto& [pair, count] : counts) shared.push_back({pair.first, pair.second, count});
  return shared;
}

}  // namespace gdtslam
