#include "session_changes.hpp"

#include <algorithm>
#include <cmath>

namespace gdtslam {
namespace {

bool is_less(CellIndex a, CellIndex b) { return a.y != b.y ? a.y < b.y : a.x < b.x; }

void make_unique(std::vector<CellIndex>& cells) {
  std::sort(cells.begin(), cells.end(), is_less);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

}  // namespace

SessionChanges::SessionChanges(const std::vector<DriveViews>& drives, double resolution_m, const ChangeLimits& limits)
    : drives_(&drives),
      resolution_m_(resolution_m),
      limits_(limits),
      judge_(resolution_m, limits),
      by_drive_(drives.size()) {
  for (const DriveViews& drive : drives) order_.push_back({drive.first_s, drive.last_s});
  std::vector<CellIndex> ended;
  for (const DriveViews& drive : drives) {
    const std::vector<CellIndex> cells = drive.views.ended();
    ended.insert(ended.end(), cells.begin(), cells.end());
  }
  make_unique(ended);
  for (const CellIndex cell : ended) judge(cell);
  const auto keep = [&](MapChanges& changes) {
    keep_patches(changes.appeared, resolution_m, limits);
    keep_patches(changes.gone, resolution_m, limits);
  };
  keep(last_);
  for (MapChanges& changes : by_drive_) keep(changes);
  overrule_around_what_is_gone();
  drives_ = nullptr;
}

bool SessionChanges::is_before(std::size_t a, std::size_t b) const { return order_[a].last_s < order_[b].first_s; }

std::vector<SessionChanges::Word> SessionChanges::collect_words(CellIndex cell) const {
  std::vector<Word> words(drives_->size(), Word::kNone);
  for (std::size_t k = 0; k < words.size(); ++k) {
    const ViewCounts& views = (*drives_)[k].views;
    const CellViews seen = views.at(cell);
    if (judge_.is_wall(seen, limits_.beside_views)) {
      words[k] = Word::kWall;
    } else if (seen.passes > 0 && judge_.is_free(views, cell)) {
      words[k] = Word::kFree;
    }
  }
  return words;
}

// Finds the drives that judged the cell and after which no other drive did.
std::vector<std::size_t> SessionChanges::find_last_words(const std::vector<Word>& words) const {
  std::vector<std::size_t> last;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (words[k] == Word::kNone) continue;
    bool is_last = true;
    for (std::size_t other = 0; other < words.size() && is_last; ++other) {
      is_last = words[other] == Word::kNone || !is_before(k, other);
    }
    if (is_last) last.push_back(k);
  }
  return last;
}

// True if enough views ended in this cell or in one beside it.
bool SessionChanges::is_strong(std::size_t drive, CellIndex cell) const {
  const ViewCounts& views = (*drives_)[drive].views;
  const std::vector<CellOffset>& disc = judge_.surroundings();
  return std::any_of(disc.begin(), disc.end(),
                     [&](CellOffset offset) { return judge_.is_wall(views.at(cell + offset), limits_.least_views); });
}

void SessionChanges::judge(CellIndex cell) {
  const std::vector<Word> words = collect_words(cell);
  const auto says_before = [&](Word wanted, std::size_t drive) {
    for (std::size_t other = 0; other < words.size(); ++other) {
      if (other != drive && words[other] == wanted && !is_before(drive, other)) return true;
    }
    return false;
  };
  const auto changed = [&](std::size_t drive) { return ChangedCell{cell, (*drives_)[drive].views.at(cell), 0}; };
  bool is_changed = false;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (words[k] == Word::kFree && says_before(Word::kWall, k)) {
      by_drive_[k].gone.push_back(changed(k));
      is_changed = true;
    } else if (words[k] == Word::kWall && says_before(Word::kFree, k) && is_strong(k, cell)) {
      by_drive_[k].appeared.push_back(changed(k));
      is_changed = true;
    }
  }
  if (!is_changed) return;
  const std::vector<std::size_t> last = find_last_words(words);
  const auto free = std::find_if(last.begin(), last.end(), [&](std::size_t k) { return words[k] == Word::kFree; });
  if (free != last.end()) {
    last_.gone.push_back(changed(*free));
  } else if (is_strong(last.front(), cell)) {
    last_.appeared.push_back(changed(last.front()));
  }
}

// Overrules single returns beside a wall that is gone.
void SessionChanges::overrule_around_what_is_gone() {
  const auto reach = static_cast<std::int32_t>(std::floor(limits_.patch_gap_m / resolution_m_));
  std::vector<CellIndex> around;
  for (const ChangedCell& gone : last_.gone) {
    for (std::int32_t y = -reach; y <= reach; ++y) {
      for (std::int32_t x = -reach; x <= reach; ++x) around.push_back(gone.cell + CellOffset{x, y});
    }
  }
  make_unique(around);
  for (const CellIndex cell : around) {
    const std::vector<Word> words = collect_words(cell);
    for (const std::size_t k : find_last_words(words)) {
      if (words[k] == Word::kFree) overruled_.push_back({cell, k});
    }
  }
}

bool SessionChanges::is_overruled(std::size_t drive, CellIndex cell) const {
  auto found = std::lower_bound(overruled_.begin(), overruled_.end(), cell,
                                [](const Overruling& a, CellIndex b) { return is_less(a.cell, b); });
  for (; found != overruled_.end() && found->cell == cell; ++found) {
    if (found->by != drive && !is_before(found->by, drive)) return true;
  }
  return false;
}

}  // namespace gdtslam
