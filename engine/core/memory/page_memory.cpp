#include "page_memory.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

namespace gdtslam {

void forget(std::span<std::byte> memory) {
  static const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
  const std::size_t lead = std::min<std::size_t>((page - address % page) % page, memory.size());
  const std::size_t whole = (memory.size() - lead) / page * page;
  std::byte* const pages = memory.data() + lead;
  const bool are_given_back = whole > 0 && ::madvise(pages, whole, MADV_DONTNEED) == 0;
  std::fill_n(memory.data(), are_given_back ? lead : memory.size(), std::byte{0});
  if (are_given_back) std::fill(pages + whole, memory.data() + memory.size(), std::byte{0});
}

}  // namespace gdtslam
