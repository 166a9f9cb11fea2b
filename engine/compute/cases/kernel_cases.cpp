#include "kernel_cases.hpp"

#include <algorithm>
#include <cstring>

#include "case_builder.hpp"
#include "engine/compute/cpu/functions.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kGuardBytes = 256;
constexpr std::byte kGuard{0xA5};

/// A part of a value, as an unsigned integer.
std::uint64_t part_at(const std::vector<std::byte>& content, std::size_t first, std::size_t bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes; i-- > 0;) {
    value = value << 8U | std::to_integer<std::uint64_t>(content[first + i]);
  }
  return value;
}

/// Difference of two values: structs are compared word by word, and the largest difference counts.
std::uint64_t value_difference(const ValueLayout& layout, std::size_t index, const std::vector<std::byte>& expected,
                               const std::vector<std::byte>& found) {
  const std::size_t bytes = layout.value_bytes;
  const std::size_t step = bytes <= 8 ? bytes : 4;
  std::uint64_t largest = 0;
  for (std::size_t offset = 0; offset < bytes; offset += step) {
    const std::size_t part = std::min(step, bytes - offset);
    const std::uint64_t a = part_at(expected, index * bytes + offset, part);
    const std::uint64_t b = part_at(found, index * bytes + offset, part);
    largest = std::max(largest, a > b ? a - b : b - a);
  }
  return largest;
}

void compare_buffer(const ValueLayout& layout, std::size_t binding, const std::vector<std::byte>& expected,
                    const std::vector<std::byte>& found, CaseDifference& result) {
  if (expected == found) {
    return;
  }
  for (std::uint32_t y = 0; y < layout.height; ++y) {
    for (std::uint32_t x = 0; x < layout.width; ++x) {
      const std::uint64_t apart = value_difference(layout, std::size_t{y} * layout.stride + x, expected, found);
      if (apart == 0) {
        continue;
      }
      if (result.values++ == 0) {
        result.binding = binding;
        result.x = x;
        result.y = y;
      }
      result.largest = std::max(result.largest, apart);
    }
  }
}

Buffer guarded_buffer(Backend& backend, const std::vector<std::byte>& content) {
  Buffer buffer = backend.allocate(content.size() + kGuardBytes);
  const std::vector<std::byte> guard(kGuardBytes, kGuard);
  backend.upload(buffer, content);
  backend.upload(buffer, guard, content.size());
  return buffer;
}

template <class K>
void add_group(std::vector<CaseGroup>& groups) {
  if constexpr (requires { K::cases(); }) groups.push_back(K::cases());
}

template <class... K>
std::vector<CaseGroup> make_groups(KernelList<K...> /*kernels*/) {
  std::vector<CaseGroup> groups;
  (add_group<K>(groups), ...);
  return groups;
}

/// In the order of the registry, except for kernels that share a group.
const std::vector<CaseGroup>& case_groups() {
  static const std::vector<CaseGroup> groups = make_groups(AllKernels{});
  return groups;
}

const std::vector<RandomKernel>& random_kernels() {
  static const std::vector<RandomKernel> list = [] {
    std::vector<RandomKernel> kernels;
    for (const CaseGroup& group : case_groups()) {
      kernels.insert(kernels.end(), group.draws.begin(), group.draws.end());
    }
    return kernels;
  }();
  return list;
}

}  // namespace

std::vector<KernelCaseSource> kernel_cases() {
  std::vector<KernelCaseSource> list;
  for (const CaseGroup& group : case_groups()) {
    group.add(list);
  }
  return list;
}

CaseOutcome run_case(Backend& backend, const KernelCase& kernel_case) {
  std::vector<Buffer> buffers;
  std::vector<const Buffer*> bound;
  buffers.reserve(kernel_case.buffers.size());
  for (const CaseBuffer& buffer : kernel_case.buffers) {
    buffers.push_back(guarded_buffer(backend, buffer.content));
    bound.push_back(&buffers.back());
  }
  backend.dispatch(*kernel_case.kernel, bound, kernel_case.params, kernel_case.threads);
  CaseOutcome outcome;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::vector<std::byte>& before = kernel_case.buffers[i].content;
    std::vector<std::byte> after(buffers[i].bytes());
    backend.download(buffers[i], after);
    const auto guard = after.begin() + static_cast<std::ptrdiff_t>(before.size());
    outcome.guards_intact &= std::all_of(guard, after.end(), [](std::byte b) { return b == kGuard; });
    after.resize(before.size());
    outcome.inputs_intact &= kernel_case.kernel->bindings[i] != Access::kRead || after == before;
    outcome.contents.push_back(std::move(after));
  }
  return outcome;
}

std::optional<CaseDifference> difference(const KernelCase& kernel_case, const CaseOutcome& expected,
                                         const CaseOutcome& found) {
  CaseDifference result;
  for (std::size_t i = 0; i < kernel_case.buffers.size(); ++i) {
    compare_buffer(kernel_case.buffers[i].layout, i, expected.contents[i], found.contents[i], result);
  }
  return result.values == 0 ? std::nullopt : std::optional(result);
}

std::uint32_t draw_count(Random& random, std::uint32_t most) {
  const std::uint64_t bits = random.below(33);
  const std::uint64_t limit = std::min<std::uint64_t>(most, (std::uint64_t{1} << bits) - 1);
  return static_cast<std::uint32_t>(random.below(limit + 1));
}

CaseSize draw_size(Random& random, std::uint32_t least) {
  constexpr std::pair<std::uint32_t, std::uint32_t> kMost[] = {{3, 3},   {20, 20},   {80, 80},   {80, 80},
                                                               {80, 80}, {300, 300}, {2000, 16}, {16, 2000}};
  const auto [most_x, most_y] = draw_from(random, kMost);
  CaseSize size{};
  size.width = least + static_cast<std::uint32_t>(random.below(most_x + 1));
  size.height = least + static_cast<std::uint32_t>(random.below(most_y + 1));
  const auto padding = static_cast<std::uint32_t>(random.below(2) == 0 ? 0 : random.below(10));
  size.stride = (size.width + 3) / 4 * 4 + 4 * padding;
  return size;
}

SeedPattern draw_pattern(Random& random) {
  constexpr SeedPattern kAll[] = {SeedPattern::kNone, SeedPattern::kOne,     SeedPattern::kSparse, SeedPattern::kHalf,
                                  SeedPattern::kAll,  SeedPattern::kCorners, SeedPattern::kChecks, SeedPattern::kWalls};
  return draw_from(random, kAll);
}

KernelCaseSource random_kernel_case(std::uint64_t seed, std::uint32_t index) {
  Random random = Random(seed).split(index);
  const RandomKernel& drawn = random_kernels()[random.below(random_kernels().size())];
  const std::string name = "random " + std::to_string(seed) + "/" + std::to_string(index);
  return {drawn.kernel, name, false, false, [drawn, name, random] {
            Random contents = random;
            return drawn.draw(name, contents);
          }};
}

std::vector<KernelCaseSource> random_kernel_cases(std::uint64_t seed, std::uint32_t count) {
  std::vector<KernelCaseSource> list;
  list.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    list.push_back(random_kernel_case(seed, i));
  }
  return list;
}

std::uint32_t draw_word(Random& random) { return static_cast<std::uint32_t>(random.bits() >> 32U); }

float draw_real(Random& random, double most) { return static_cast<float>(random.uniform(-most, most)); }

CaseBuffer noise_buffer(std::uint32_t words, Random& random) {
  return list_buffer(noise<std::uint32_t>({words, 1, words}, random.bits()));
}

}  // namespace gdtslam
