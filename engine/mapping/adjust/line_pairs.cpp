#include "line_pairs.hpp"

#include <algorithm>
#include <utility>

#include "engine/compute/device_memory.hpp"
#include "engine/compute/kernels/host_kernels.hpp"

namespace gdtslam {
namespace {

std::size_t value_bytes(std::span<const LineScan> scans) {
  std::size_t values = 0;
  for (const LineScan& scan : scans) values += scan.values().size();
  return values * sizeof(float);
}

}  // namespace

LinePairs::LinePairs(std::span<const LineScan> fixed, WorkerPool& workers, BatchDevice device)
    : fixed_(fixed), fixed_bytes_(value_bytes(fixed)), workers_(&workers), device_(std::move(device)) {}

bool LinePairs::fits(const Backend& backend, std::size_t moving_bytes) const {
  const std::size_t bins = fixed_.size() * PointToLine::kBins * sizeof(std::uint16_t);
  return std::max(fixed_bytes_ + moving_bytes, bins) <= backend.device().max_buffer_bytes;
}

void LinePairs::build(std::span<const LineScan> moving, const LineGate& gate, std::span<LinePair> pairs) {
  Backend* const backend = device_.get();
  if (backend != nullptr && fits(*backend, moving.data() == fixed_.data() ? 0 : value_bytes(moving))) {
    try {
      return build_on_device(*backend, moving, gate, pairs);
    } catch (const DeviceError& error) {
      for (Buffer* const buffer : {&values_, &bins_, &pairs_, &sums_}) *buffer = {};
      device_.lost(error);
    }
  }
  build_on_host(moving, gate, pairs);
}

void LinePairs::build_on_host(std::span<const LineScan> moving, const LineGate& gate, std::span<LinePair> pairs) {
  const PointToLine::Params params = line_params(gate);
  const Isa isa = best_isa();
  workers_->run(pairs.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
    for (LinePair& pair : pairs.subspan(begin, end - begin)) {
      if (!pair.is_wanted) continue;
      const PointToLine::Scan fixed = fixed_[pair.fixed].view();
      const LineScan& scan = moving[pair.moving];
      const TakenShare taken(scan.size(), gate.points);
      if (!pair.is_found || pair.lines.empty()) {
        pair.lines.resize(taken.count);
        find_lines_host(isa, params, line_pose(pair.found_at), fixed, scan.view(), taken.every, pair.lines);
      }
      pair.equations =
          to_equations(line_slope_host(isa, params, line_pose(pair.at), fixed, scan.view(), taken.every, pair.lines));
    }
  });
}

// Leaves room for the scans that move behind the fixed ones.
void LinePairs::upload_fixed(Backend& backend, std::size_t moving_bytes) {
  std::vector<float> values;
  std::vector<std::uint16_t> bins;
  first_value_.clear();
  for (const LineScan& scan : fixed_) {
    first_value_.push_back(static_cast<std::uint32_t>(values.size()));
    values.insert(values.end(), scan.values().begin(), scan.values().end());
    bins.insert(bins.end(), scan.bins().begin(), scan.bins().end());
  }
  first_value_.push_back(static_cast<std::uint32_t>(values.size()));
  values_ = {};
  reserve_on(backend, values_, std::max<std::size_t>(4, fixed_bytes_ + moving_bytes));
  bins_ = backend.allocate(std::max<std::size_t>(4, bins.size() * sizeof(std::uint16_t)));
  if (!values.empty()) backend.upload(values_, std::as_bytes(std::span(values)));
  if (!bins.empty()) backend.upload(bins_, std::as_bytes(std::span(bins)));
}

void LinePairs::upload_moving(Backend& backend, std::span<const LineScan> moving) {
  moving_first_.clear();
  moving_values_.clear();
  for (const LineScan& scan : moving) {
    moving_first_.push_back(first_value_.back() + static_cast<std::uint32_t>(moving_values_.size()));
    moving_values_.insert(moving_values_.end(), scan.values().begin(), scan.values().end());
  }
  if (moving_values_.empty()) return;
  backend.upload(values_, std::as_bytes(std::span(moving_values_)), first_value_.back() * sizeof(float));
}

void LinePairs::build_on_device(Backend& backend, std::span<const LineScan> moving, const LineGate& gate,
                                std::span<LinePair> pairs) {
  const bool is_own = moving.data() == fixed_.data();
  const std::size_t moving_bytes = is_own ? 0 : value_bytes(moving);
  if (values_.bytes() < std::max<std::size_t>(4, fixed_bytes_ + moving_bytes)) upload_fixed(backend, moving_bytes);
  if (!is_own) upload_moving(backend, moving);
  const std::vector<std::uint32_t>& first_of = is_own ? first_value_ : moving_first_;
  std::vector<PointToLine::Pair> rows;
  std::vector<LinePair*> wanted;
  for (LinePair& pair : pairs) {
    if (!pair.is_wanted) continue;
    const PointToLine::Scan fixed = fixed_[pair.fixed].view();
    const LineScan& scan = moving[pair.moving];
    const TakenShare taken(scan.size(), gate.points);
    rows.push_back({.found = line_pose(pair.found_at),
                    .at = line_pose(pair.at),
                    .low = fixed.low,
                    .high = fixed.high,
                    .fixed = first_value_[pair.fixed],
                    .fixed_count = fixed.count,
                    .bins = static_cast<std::uint32_t>(pair.fixed * PointToLine::kBins),
                    .moving = first_of[pair.moving],
                    .moving_count = scan.view().count,
                    .every = taken.every,
                    .taken = taken.count});
    wanted.push_back(&pair);
  }
  if (rows.empty()) return;
  std::vector<PointToLine::Sums> sums(rows.size());
  reserve_on(backend, pairs_, rows.size() * sizeof(rows.front()));
  reserve_on(backend, sums_, sums.size() * sizeof(sums.front()));
  backend.upload(pairs_, std::as_bytes(std::span(rows)));
  run<PointToLine>(backend, line_params(gate), {static_cast<std::uint32_t>(rows.size()), 1, 1}, values_, bins_, pairs_,
                   sums_);
  backend.download(sums_, std::as_writable_bytes(std::span(sums)));
  for (std::size_t i = 0; i < sums.size(); ++i) wanted[i]->equations = to_equations(sums[i]);
}

}  // namespace gdtslam
