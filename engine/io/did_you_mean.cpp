#include "did_you_mean.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gdtslam {
namespace {

constexpr std::size_t kMaxLength = 128;  // longer names are not misspelt ones of ours

/// Insertions, deletions, replacements and swaps of neighbours between two names (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Rows i - 2, i - 1 and i of the table of distances between beginnings.
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before_last, last);
    std::swap(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
  }
  return row[b.size()];
}

std::string_view last_part(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string_view::npos ? path : path.substr(dot + 1);
}

}  // namespace

std::optional<std::string_view> nearest_name(std::string_view name, std::span<const std::string_view> names) {
  if (name.empty() || name.size() > kMaxLength) {
    return std::nullopt;
  }
  std::optional<std::string_view> nearest;
  std::size_t nearest_distance = 0;
  for (const std::string_view candidate : names) {
    if (candidate.size() > kMaxLength) continue;
    const bool is_bare = name.find('.') == std::string_view::npos;
    const std::string_view compared = is_bare ? last_part(candidate) : candidate;
    const std::size_t limit = std::max<std::size_t>(1, std::max(name.size(), compared.size()) / 3);
    std::size_t distance = edit_distance(name, compared);
    // The right name in the wrong section also counts as near.
    if (!is_bare && last_part(name) == last_part(candidate)) distance = std::min(distance, limit);
    if (distance <= limit && (!nearest || distance < nearest_distance)) {
      nearest = candidate;
      nearest_distance = distance;
    }
  }
  return nearest;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& names) {
  const std::vector<std::string_view> views(names.begin(), names.end());
  const auto nearest = nearest_name(word, views);
  return nearest ? "; did you mean '" + std::string(*nearest) + "'?" : "";
}

}  // namespace gdtslam
