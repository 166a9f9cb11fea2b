#include "shards.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <queue>
#include <string_view>
#include <utility>

#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr double kShard_s = 600.0;
constexpr double kUnknown_s = 60.0;
// Of CARMEN text, which has 5 to 6 bytes a beam; measured 0.65 to 1.35 MB a core-second with loops and pictures.
constexpr double kBytesPerSecond = 1.0e6;
constexpr double kRecordedPerSecond = 4.0e6;  // of messages, which have 4 bytes a beam, and intensities
constexpr double kPerLog_s = 5.0;             // whatever its size: above all, how late its odometry is stamped
constexpr double kPackedRatio = 4.8;          // of its gzip, measured 4.6 to 5.2

std::uint64_t number_from(const std::string& text, const char* what) {
  std::uint64_t number = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc{} || end != text.data() + text.size())
    throw UsageError(fmt::format("{}: {} is no whole number", what, in_quotes(text)));
  return number;
}

/// How a scheduler says which of how many tasks a process is.
struct SchedulerVariables {
  const char* index;
  const char* first;  ///< of the array; null: 0
  const char* last;   ///< likewise; null: there is no gap
  const char* count;
};
constexpr std::array<SchedulerVariables, 3> kSchedulers{
    {{"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_MAX", "SLURM_ARRAY_TASK_COUNT"},
     {"AWS_BATCH_JOB_ARRAY_INDEX", nullptr, nullptr, "AWS_BATCH_JOB_ARRAY_SIZE"},
     {"JOB_COMPLETION_INDEX", nullptr, nullptr, "JOB_COMPLETIONS"}}};

// The tasks of a list or of every tenth number do not say which part of all each is.
void require_no_gaps(const SchedulerVariables& scheduler, const Environment& environment, const ShardChoice& choice) {
  if (scheduler.last == nullptr || !choice.of) return;
  const std::optional<std::string> last = environment(scheduler.last);
  const std::uint64_t first = number_from(environment(scheduler.first).value_or("0"), scheduler.first);
  if (!last || number_from(*last, scheduler.last) == first + *choice.of - 1) return;
  throw UsageError(
      fmt::format("--shard auto: the array from {} to {} has {} tasks, so that none says which part it is: "
                  "submit again, which begins what is missing, or give --shard I/N",
                  first, *last, *choice.of));
}

ShardChoice automatic_choice(const Environment& environment) {
  for (const SchedulerVariables& scheduler : kSchedulers) {
    const std::optional<std::string> index = environment(scheduler.index);
    if (!index) continue;
    ShardChoice choice{.index = number_from(*index, scheduler.index), .of = {}, .said_by = {}};
    choice.said_by = fmt::format("{}={}", scheduler.index, *index);
    if (scheduler.first != nullptr) {
      const std::uint64_t first = number_from(environment(scheduler.first).value_or("0"), scheduler.first);
      if (first > choice.index) throw UsageError(fmt::format("{} is below {}", scheduler.index, scheduler.first));
      choice.index -= first;
    }
    if (const std::optional<std::string> count = environment(scheduler.count)) {
      choice.of = number_from(*count, scheduler.count);
      choice.said_by += fmt::format(" of {}={}", scheduler.count, *count);
    }
    require_no_gaps(scheduler, environment, choice);
    return choice;
  }
  throw UsageError(
      "--shard auto: no scheduler says which part this is: SLURM_ARRAY_TASK_ID, AWS_BATCH_JOB_ARRAY_INDEX and "
      "JOB_COMPLETION_INDEX are not set; give --shard I/N");
}

}  // namespace

double estimated_work_s(const FleetUnit& unit) {
  if (unit.bytes == 0) return kUnknown_s;
  std::string_view name = unit.uri;
  double bytes = static_cast<double>(unit.bytes);
  for (const std::string_view ending : {".gz", ".bz2", ".xz", ".zst"}) {
    if (!name.ends_with(ending)) continue;
    bytes *= kPackedRatio;
    name.remove_suffix(ending.size());
  }
  const bool is_recording = name.ends_with(".bag") || name.ends_with(".mcap") || name.ends_with(".db3");
  return kPerLog_s + bytes / (is_recording ? kRecordedPerSecond : kBytesPerSecond);
}

std::vector<std::vector<std::uint32_t>> packed_shards(const std::vector<FleetUnit>& units, std::size_t count) {
  double all_s = 0.0;
  for (const FleetUnit& unit : units) all_s += estimated_work_s(unit);
  if (count == 0) count = static_cast<std::size_t>(std::ceil(std::min(all_s / kShard_s, double{kMostShards})));
  count = std::clamp<std::size_t>(count, 1, std::min(units.size(), kMostShards));
  std::vector<std::uint32_t> order(units.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&units](std::uint32_t a, std::uint32_t b) {
    return estimated_work_s(units[a]) > estimated_work_s(units[b]);
  });
  using Load = std::pair<double, std::size_t>;
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (std::size_t k = 0; k < count; ++k) loads.emplace(0.0, k);
  std::vector<std::vector<std::uint32_t>> shards(count);
  for (const std::uint32_t unit : order) {
    auto [load_s, shard] = loads.top();
    loads.pop();
    shards[shard].push_back(unit);
    loads.emplace(load_s + estimated_work_s(units[unit]), shard);
  }
  for (auto& shard : shards) std::sort(shard.begin(), shard.end());
  return shards;
}

ShardChoice shard_choice(const std::string& text, const Environment& environment) {
  if (text == "auto") return automatic_choice(environment);
  const std::size_t slash = text.find('/');
  ShardChoice choice;
  const std::uint64_t number = number_from(text.substr(0, slash), "--shard");
  if (slash != std::string::npos) choice.of = number_from(text.substr(slash + 1), "--shard");
  if (number == 0 || (choice.of && number > *choice.of))
    throw UsageError(fmt::format("--shard: {} is none: shards are 1 to N", in_quotes(text)));
  choice.index = number - 1;
  return choice;
}

std::vector<std::size_t> chosen_shards(const ShardChoice& choice, std::size_t shards) {
  const std::size_t of = choice.of.value_or(shards);
  if (choice.index >= of || of == 0)
    throw UsageError(
        fmt::format("{}: the plan has {} shards", choice.said_by.empty() ? "--shard" : choice.said_by, shards));
  std::vector<std::size_t> chosen;
  for (std::size_t k = choice.index; k < shards; k += of) chosen.push_back(k);
  return chosen;
}

}  // namespace gdtslam
