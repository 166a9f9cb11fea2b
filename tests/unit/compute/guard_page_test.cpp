// Kernels between pages that cannot be touched: every buffer of every case lies once directly before such a page and
// once directly behind one, without any padding after its last value. A stray read or write is a crash.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <utility>

#include "engine/compute/cases/kernel_cases.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

/// Memory between two pages without access.
class Fenced {
 public:
  Fenced(const std::vector<std::byte>& content, bool at_end) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t inner = (content.size() + page - 1) / page * page;
    mapped_ = inner + 2 * page;
    memory_ = static_cast<std::byte*>(mmap(nullptr, mapped_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (inner > 0) {
      mprotect(memory_ + page, inner, PROT_READ | PROT_WRITE);
    }
    bytes_ = {memory_ + page + (at_end ? inner - content.size() : 0), content.size()};
    if (!content.empty()) {
      std::memcpy(bytes_.data(), content.data(), content.size());
    }
  }
  Fenced(const Fenced&) = delete;
  Fenced& operator=(const Fenced&) = delete;
  Fenced(Fenced&& other) noexcept
      : memory_(std::exchange(other.memory_, nullptr)), mapped_(other.mapped_), bytes_(other.bytes_) {}
  Fenced& operator=(Fenced&&) = delete;
  ~Fenced() {
    if (memory_ != nullptr) {
      munmap(memory_, mapped_);
    }
  }
  [[nodiscard]] std::span<std::byte> bytes() const { return bytes_; }

 private:
  std::byte* memory_ = nullptr;
  std::size_t mapped_ = 0;
  std::span<std::byte> bytes_;
};

/// The content without the padding of the last row.
std::vector<std::byte> trimmed(const CaseBuffer& buffer) {
  const ValueLayout& layout = buffer.layout;
  const std::size_t padding = layout.height == 0 ? 0 : layout.stride - layout.width;
  const std::size_t kept = buffer.content.size() - padding * layout.value_bytes;
  return {buffer.content.begin(), buffer.content.begin() + static_cast<std::ptrdiff_t>(kept)};
}

std::vector<std::vector<std::byte>> run_fenced(const KernelCase& kernel_case, Isa isa, bool at_end) {
  std::vector<Fenced> fenced;
  std::vector<std::span<std::byte>> spans;
  for (const CaseBuffer& buffer : kernel_case.buffers) {
    fenced.emplace_back(trimmed(buffer), at_end);
    spans.push_back(fenced.back().bytes());
  }
  const std::uint32_t count = kernel_case.threads.y > 1 ? kernel_case.threads.y : kernel_case.threads.x;
  kernel_case.kernel->cpu[static_cast<std::size_t>(isa)]({spans, kernel_case.params, kernel_case.threads, 0, count});
  std::vector<std::vector<std::byte>> after;
  for (const std::span<std::byte> span : spans) {
    after.emplace_back(span.begin(), span.end());
  }
  return after;
}

TEST(GuardPages, NoKernelTouchesWhatIsNotItsOwn) {
  for (const KernelCaseSource& source : kernel_cases()) {
    if (source.benchmark || source.large) {
      continue;
    }
    const KernelCase kernel_case = source.make();
    if (kernel_case.threads.x == 0 || kernel_case.threads.y == 0) {
      continue;
    }
    const auto expected = run_fenced(kernel_case, Isa::kBaseline, true);
    for (const Isa isa : available_isas()) {
      for (const bool at_end : {false, true}) {
        ASSERT_TRUE(run_fenced(kernel_case, isa, at_end) == expected)
            << source.kernel->name << ' ' << source.name << ' ' << to_string(isa);
      }
    }
  }
}

}  // namespace
}  // namespace gdtslam::test
