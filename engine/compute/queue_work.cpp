#include "gdtslam/compute/backend.hpp"

namespace gdtslam {

std::uint64_t QueueWork::dispatch_sum() const {
  std::uint64_t sum = 0;
  for (const auto& [kernel, count] : dispatches) sum += count;
  return sum;
}

QueueWork operator-(const QueueWork& now, const QueueWork& before) {
  QueueWork between = now;
  for (const auto& [kernel, count] : before.dispatches) between.dispatches[kernel] -= count;
  std::erase_if(between.dispatches, [](const auto& row) { return row.second == 0; });
  between.submissions -= before.submissions;
  between.waits -= before.waits;
  between.wait_s -= before.wait_s;
  between.barriers -= before.barriers;
  between.fills -= before.fills;
  between.uploads -= before.uploads;
  between.upload_bytes -= before.upload_bytes;
  between.downloads -= before.downloads;
  between.download_bytes -= before.download_bytes;
  return between;
}

QueueWork& operator+=(QueueWork& sum, const QueueWork& more) {
  for (const auto& [kernel, count] : more.dispatches) sum.dispatches[kernel] += count;
  sum.submissions += more.submissions;
  sum.waits += more.waits;
  sum.wait_s += more.wait_s;
  sum.barriers += more.barriers;
  sum.fills += more.fills;
  sum.uploads += more.uploads;
  sum.upload_bytes += more.upload_bytes;
  sum.downloads += more.downloads;
  sum.download_bytes += more.download_bytes;
  return sum;
}

}  // namespace gdtslam
