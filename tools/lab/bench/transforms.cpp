#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/compute/cases/kernel_cases.hpp"
#include "engine/compute/kernels/edt/edt.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "gdtslam/core/error.hpp"
#include "rows.hpp"

#ifdef GDTSLAM_HAVE_OPENCV
#include <opencv2/imgproc.hpp>
#endif

namespace gdtslam {
namespace {

constexpr std::uint64_t kRandomSeed = 1;
constexpr std::uint32_t kNearRadius = 20;
constexpr std::uint32_t kFarRadius = 255;
constexpr JumpFloodVariant kVariants[] = {JumpFloodVariant::kPlain, JumpFloodVariant::kOnePlus,
                                          JumpFloodVariant::kPlusTwo, JumpFloodVariant::kSquared};

/// Throws UsageError where the device has no buffers for such a square.
std::uint32_t fitting_size(const Backend& backend, std::uint32_t size) {
  const std::size_t most = backend.device().max_buffer_bytes;
  if (most == 0 || std::size_t{4} * grid_stride(size) * size <= most) return size;
  throw UsageError(fmt::format("bench: --size {} is too large for {}, whose buffers have {} bytes at most", size,
                               backend.device().name, most));
}

/// A square with obstacles and the buffers that all transforms need.
class Square {
 public:
  Square(Backend& backend, SeedPattern pattern, std::uint32_t size)
      : backend_(backend),
        size_(fitting_size(backend, size)),
        stride_(grid_stride(size)),
        seeds_(make_seeds(pattern, size, size, stride_, kRandomSeed)),
        seed_buffer_(backend.allocate(cells())),
        columns_(backend.allocate(cells() * 4)),
        result_(backend.allocate(cells() * 4)) {
    backend.upload(seed_buffer_, std::as_bytes(std::span(seeds_)));
    exact(kFarRadius);
    expected_ = distances();
  }

  [[nodiscard]] std::size_t cells() const { return std::size_t{stride_} * size_; }
  [[nodiscard]] const std::vector<std::uint8_t>& seeds() const { return seeds_; }

  void exact(std::uint32_t radius) {
    const EdtColumns::Params params{size_, size_, stride_, radius};
    run<EdtColumns>(backend_, params, {size_, 1, 1}, seed_buffer_, columns_);
    run<EdtRows>(backend_, params, {1, size_, 1}, columns_, result_);
  }
  void flood(std::span<const std::uint32_t> steps, std::uint32_t radius) {
    const Extent all{size_, size_, 1};
    run<JumpFloodInit>(backend_, {size_, size_, stride_}, all, seed_buffer_, columns_);
    for (const std::uint32_t step : steps) {
      run<JumpFloodStep>(backend_, {size_, size_, stride_, step}, all, columns_, result_);
      std::swap(columns_, result_);
    }
    run<JumpFloodDistance>(backend_, {size_, size_, stride_, radius}, all, columns_, result_);
  }
  /// Squared distances of the last transform.
  std::vector<std::uint16_t> distances() {
    std::vector<std::uint16_t> values(cells());
    backend_.download(result_, std::as_writable_bytes(std::span(values)));
    return values;
  }
  /// Those of the exact transform.
  [[nodiscard]] const std::vector<std::uint16_t>& expected() const { return expected_; }
  [[nodiscard]] std::uint64_t count_different(std::uint32_t radius) {
    const std::vector<std::uint16_t> found = distances();
    std::uint64_t different = 0;
    for (std::size_t i = 0; i < expected_.size(); ++i) {
      different += found[i] != std::min<std::uint32_t>(expected_[i], radius * radius) ? 1U : 0U;
    }
    return different;
  }
  [[nodiscard]] double area() const { return static_cast<double>(size_) * size_; }
  [[nodiscard]] JumpFloodInit::Params shape() const { return {size_, size_, stride_}; }
  /// A transform as work to be timed.
  Work work(std::function<void()> step) { return work_on(backend_, result_, std::move(step)); }

 private:
  Backend& backend_;
  std::uint32_t size_;
  std::uint32_t stride_;
  std::vector<std::uint8_t> seeds_;
  std::vector<std::uint16_t> expected_;
  Buffer seed_buffer_;
  Buffer columns_;
  Buffer result_;
};

void measure_exact(benchmark::State& state, Square& square, std::uint32_t radius) {
  time_work(state, square.work([&] { square.exact(radius); }), square.area(), "cell");
  state.counters["different"] = static_cast<double>(square.count_different(radius));
}

/// The steps that a map takes with map.transform=jump-flood.
void measure_near_flood(benchmark::State& state, Square& square) {
  const std::vector<std::uint32_t> steps = jump_flood_steps_within(kNearRadius);
  time_work(state, square.work([&] { square.flood(steps, kNearRadius); }), square.area(), "cell");
  state.counters["different"] = static_cast<double>(square.count_different(kNearRadius));
}

void measure_flood(benchmark::State& state, Square& square, JumpFloodVariant variant) {
  const auto side = square.shape();
  const std::vector<std::uint32_t> steps = jump_flood_steps(variant, side.width, side.height);
  time_work(state, square.work([&] { square.flood(steps, kFarRadius); }), square.area(), "cell");
  const JumpFloodError error = jump_flood_error(square.expected(), square.distances(), side);
  state.counters["passes"] = static_cast<double>(steps.size());
  state.counters["different"] = static_cast<double>(error.wrong_cells);
  state.counters["largest_error_cells"] = error.largest_cells;
}

#ifdef GDTSLAM_HAVE_OPENCV
// The peer, on one thread. OpenCV is optional and serves this comparison only.
void measure_opencv(benchmark::State& state, Square& square, int mask) {
  const int side = static_cast<int>(square.shape().width);
  const auto stride = static_cast<std::size_t>(grid_stride(square.shape().width));
  std::vector<std::uint8_t> input;  // OpenCV measures the distance to zeros
  for (const std::uint8_t seed : square.seeds()) input.push_back(seed == 0 ? 1 : 0);
  const cv::Mat source(side, side, CV_8UC1, input.data(), stride);
  cv::Mat target(side, side, CV_32FC1);
  cv::setNumThreads(1);
  const auto transform = [&] { cv::distanceTransform(source, target, cv::DIST_L2, mask); };
  time_work(state, {.step = transform}, square.area(), "cell");
  std::uint64_t different = 0;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double found = std::min(static_cast<double>(target.at<float>(y, x)), static_cast<double>(kFarRadius));
      const std::uint16_t exact = square.expected()[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x)];
      different += std::fabs(found * found - static_cast<double>(exact)) > 0.5 ? 1U : 0U;
    }
  }
  state.counters["different"] = static_cast<double>(different);
}
#endif

}  // namespace

std::string opencv_version() {
#ifdef GDTSLAM_HAVE_OPENCV
  return CV_VERSION;
#else
  return {};
#endif
}

void add_transforms(const BenchTarget& target, std::uint32_t size) {
  const auto add = [&target, side = fmt::format("{0}x{0} ", size)](const char* group, std::string_view name,
                                                                   const std::string& variant, auto measure) {
    add_row(target, group, name, side + variant, std::move(measure));
  };
  for (const SeedPattern pattern : {SeedPattern::kWalls, SeedPattern::kSparse}) {
    const auto square = shared_by_rows(
        [&backend = target.backend, pattern, size] { return std::make_shared<Square>(backend, pattern, size); });
    const bool is_sparse = pattern == SeedPattern::kSparse;  // for the errors of jump flooding alone
    for (const JumpFloodVariant variant : kVariants) {
      add("transform", "jump_flood", (is_sparse ? "1% " : "") + std::string(to_string(variant)),
          [square, variant](benchmark::State& state) { measure_flood(state, square(), variant); });
    }
    if (is_sparse) continue;
    for (const std::uint32_t radius : {kFarRadius, kNearRadius}) {
      add("transform", "edt", fmt::format("R {}", radius),
          [square, radius](benchmark::State& state) { measure_exact(state, square(), radius); });
    }
    add("transform", "jump_flood", fmt::format("R {}", kNearRadius),
        [square](benchmark::State& state) { measure_near_flood(state, square()); });
#ifdef GDTSLAM_HAVE_OPENCV
    if (!target.is_cpu()) continue;
    for (const auto& [mask, name] :
         {std::pair{cv::DIST_MASK_PRECISE, "DIST_MASK_PRECISE"}, std::pair{cv::DIST_MASK_5, "DIST_MASK_5"}}) {
      add("peer", "OpenCV " + opencv_version(), name,
          [square, mask = mask](benchmark::State& state) { measure_opencv(state, square(), mask); });
    }
#endif
  }
}

}  // namespace gdtslam
