#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "engine/compute/cases/kernel_cases.hpp"
#include "engine/compute/kernels/edt/edt.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
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

/// A square with obstacles and the buffers that all transforms need.
class Square {
 public:
  Square(Backend& backend, SeedPattern pattern, std::uint32_t size)
      : backend_(backend),
        size_(size),
        stride_(grid_stride(size)),
        seeds_(make_seeds(pattern, size, size, stride_, kRandomSeed)),
        seed_buffer_(backend.allocate(cells())),
        columns_(backend.allocate(cells() * 4)),
        result_(backend.allocate(cells() * 4)) {
    backend.upload(seed_buffer_, std::as_bytes(std::span(seeds_)));
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
  [[nodiscard]] JumpFloodInit::Params shape() const { return {size_, size_, stride_}; }
  /// A transform as work to be timed.
  Work work(std::function<void()> step) { return work_on(backend_, result_, std::move(step)); }

 private:
  Backend& backend_;
  std::uint32_t size_;
  std::uint32_t stride_;
  std::vector<std::uint8_t> seeds_;
  Buffer seed_buffer_;
  Buffer columns_;
  Buffer result_;
};

BenchRow transform_row(std::string_view name, const std::string& variant, std::uint32_t size, const Work& work,
                       const TimingOptions& options) {
  return measured_row("transform", name, std::to_string(size) + "x" + std::to_string(size) + " " + variant, "cell",
                      static_cast<double>(size) * size, work, options);
}

std::uint64_t count_different(const std::vector<std::uint16_t>& exact, const std::vector<std::uint16_t>& found,
                              std::uint32_t radius) {
  std::uint64_t different = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    different += found[i] != std::min<std::uint32_t>(exact[i], radius * radius) ? 1U : 0U;
  }
  return different;
}

#ifdef GDTSLAM_HAVE_OPENCV
// The peer, on one thread. OpenCV is optional and serves this comparison only.
void add_opencv(std::vector<BenchRow>& rows, const Square& square, const std::vector<std::uint16_t>& exact,
                std::uint32_t size, const TimingOptions& options) {
  if (square.cells() != std::size_t{size} * size) return;
  std::vector<std::uint8_t> input;  // OpenCV measures the distance to zeros
  for (const std::uint8_t seed : square.seeds()) input.push_back(seed == 0 ? 1 : 0);
  std::vector<float> distance(input.size());
  const int side = static_cast<int>(size);
  const cv::Mat source(side, side, CV_8UC1, input.data());
  cv::Mat target(side, side, CV_32FC1, distance.data());
  cv::setNumThreads(1);
  for (const auto& [mask, name] :
       {std::pair{cv::DIST_MASK_PRECISE, "DIST_MASK_PRECISE"}, std::pair{cv::DIST_MASK_5, "DIST_MASK_5"}}) {
    const auto transform = [&, mask = mask] { cv::distanceTransform(source, target, cv::DIST_L2, mask); };
    BenchRow row = transform_row("OpenCV " + opencv_version(), name, size, {.step = transform}, options);
    row.group = "peer";
    row.different = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const double found = std::min(static_cast<double>(distance[i]), static_cast<double>(kFarRadius));
      *row.different += std::fabs(found * found - static_cast<double>(exact[i])) > 0.5 ? 1U : 0U;
    }
    rows.push_back(std::move(row));
  }
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

std::uint32_t largest_transform(std::size_t buffer_bytes, std::uint32_t most) {
  std::uint32_t size = most;
  while (size > 0 && std::size_t{4} * grid_stride(size) * size > buffer_bytes) --size;
  return size;
}

std::vector<BenchRow> bench_transforms(Backend& backend, std::uint32_t size, const TimingOptions& options) {
  Square square(backend, SeedPattern::kWalls, size);
  std::vector<BenchRow> rows;
  std::vector<std::uint16_t> exact;
  for (const std::uint32_t radius : {kFarRadius, kNearRadius}) {
    rows.push_back(
        transform_row("edt", "R " + std::to_string(radius), size, square.work([&] { square.exact(radius); }), options));
    if (exact.empty()) exact = square.distances();
    rows.back().different = count_different(exact, square.distances(), radius);
  }
  // What a map takes with map.transform=jump-flood.
  const std::vector<std::uint32_t> near_steps = jump_flood_steps_within(kNearRadius);
  rows.push_back(transform_row("jump_flood", "R " + std::to_string(kNearRadius), size,
                               square.work([&] { square.flood(near_steps, kNearRadius); }), options));
  rows.back().different = count_different(exact, square.distances(), kNearRadius);
  for (const JumpFloodVariant variant : kVariants) {
    const std::vector<std::uint32_t> steps = jump_flood_steps(variant, size, size);
    rows.push_back(transform_row("jump_flood", std::string(to_string(variant)), size,
                                 square.work([&] { square.flood(steps, kFarRadius); }), options));
    rows.back().different = jump_flood_error(exact, square.distances(), square.shape()).wrong_cells;
  }
#ifdef GDTSLAM_HAVE_OPENCV
  if (backend.device().kind == "cpu") add_opencv(rows, square, exact, size, options);
#endif
  for (const BenchRow& peer : rows) {
    if (peer.group != "peer" || !peer.variant.ends_with("PRECISE")) continue;
    for (BenchRow& row : rows) row.times_opencv = peer.timing.cpu_s / row.timing.cpu_s;
    break;
  }
  return rows;
}

std::vector<FloodErrorRow> flood_errors(Backend& backend, std::uint32_t size) {
  std::vector<FloodErrorRow> rows;
  for (const SeedPattern pattern : {SeedPattern::kWalls, SeedPattern::kSparse}) {
    Square square(backend, pattern, size);
    square.exact(kFarRadius);
    const std::vector<std::uint16_t> exact = square.distances();
    for (const JumpFloodVariant variant : kVariants) {
      const std::vector<std::uint32_t> steps = jump_flood_steps(variant, size, size);
      square.flood(steps, kFarRadius);
      const JumpFloodError error = jump_flood_error(exact, square.distances(), square.shape());
      rows.push_back({size, std::string(to_string(pattern)), std::string(to_string(variant)), steps.size(),
                      error.wrong_cells, static_cast<double>(error.wrong_cells) / static_cast<double>(error.cells),
                      error.largest_cells});
    }
  }
  return rows;
}

}  // namespace gdtslam
