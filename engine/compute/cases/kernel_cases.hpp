// The list of cases for every kernel, as data: the equivalence tests, the benchmark and `gdtslam verify` share it.
// Contents come from fixed seeds by the project's own generator, so a case has the same bytes everywhere. Thread-safe;
// a case is built on demand and costs its buffers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/compute/backend.hpp"
#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

/// Layout of a buffer's values: rows of `stride` values, the first `width` of which count.
struct ValueLayout {
  std::uint32_t value_bytes = 1;
  std::uint32_t width = 0;
  std::uint32_t height = 1;
  std::uint32_t stride = 0;
};

/// A buffer of a case before the dispatch. Outputs and the padding of rows hold noise.
struct CaseBuffer {
  ValueLayout layout;
  std::vector<std::byte> content;
};

/// A complete dispatch.
struct KernelCase {
  const KernelInfo* kernel = nullptr;
  std::string name;
  std::vector<std::byte> params;
  Extent threads;
  std::vector<CaseBuffer> buffers;
};

/// A row of the list.
struct KernelCaseSource {
  const KernelInfo* kernel = nullptr;
  std::string name;        ///< unique within the kernel
  bool benchmark = false;  ///< true for sizes worth timing
  bool large = false;      ///< takes long: quick runs leave it out
  std::function<KernelCase()> make;
};

/// Every case of every kernel, grouped by kernel in the order of the registry.
std::vector<KernelCaseSource> kernel_cases();

/// `count` random cases: kernel, sizes, parameters and contents. Case i is named "random SEED/i" and depends on these
/// two numbers alone, so random_kernel_case(SEED, i) makes it again.
std::vector<KernelCaseSource> random_kernel_cases(std::uint64_t seed, std::uint32_t count);
KernelCaseSource random_kernel_case(std::uint64_t seed, std::uint32_t index);

/// Result of a case: the buffers' bytes after the dispatch.
struct CaseOutcome {
  std::vector<std::vector<std::byte>> contents;
  bool guards_intact = true;  ///< the bytes behind every buffer are unchanged
  bool inputs_intact = true;  ///< no read-only buffer has changed
};

/// Runs a case on a backend, each buffer followed by a guard region in the same allocation.
CaseOutcome run_case(Backend& backend, const KernelCase& kernel_case);

/// Differences between two outcomes of one case; padding of rows does not count.
struct CaseDifference {
  std::uint64_t values = 0;   ///< number of different values
  std::uint64_t largest = 0;  ///< largest difference of two values, as unsigned integers
  std::size_t binding = 0;    ///< binding of the first difference
  std::uint32_t x = 0;
  std::uint32_t y = 0;
};
/// Returns the first difference, or none if the outcomes are equal.
std::optional<CaseDifference> difference(const KernelCase& kernel_case, const CaseOutcome& expected,
                                         const CaseOutcome& found);

/// Shapes of obstacles for the distance transforms.
enum class SeedPattern : std::uint8_t { kNone, kOne, kSparse, kHalf, kAll, kCorners, kChecks, kWalls };
std::string_view to_string(SeedPattern pattern);
/// Seeds of a pattern; bytes beyond the width are noise. kWalls: straight walls that cover 1.5 % of the cells.
std::vector<std::uint8_t> make_seeds(SeedPattern pattern, std::uint32_t width, std::uint32_t height,
                                     std::uint32_t stride, std::uint64_t random_seed);

}  // namespace gdtslam
