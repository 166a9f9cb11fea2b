#include "guard.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <string_view>

#include "engine/core/memory/out_of_memory.hpp"

namespace gdtslam::c {
namespace {

constexpr std::size_t kTextBegin = offsetof(gdtslam_error, text);

// At most `most` bytes of the text, without cutting a character of several bytes.
std::string_view cut_to(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text;
  const auto continues = [&text](std::size_t at) { return (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U; };
  while (most > 0 && continues(most)) --most;
  return text.substr(0, most);
}

// Allocates no memory, because there may be none.
gdtslam_status tell(gdtslam_error* error, gdtslam_status status, std::string_view text) noexcept {
  if (error == nullptr || error->size <= kTextBegin) return status;
  error->status = status;
  const std::string_view shown = cut_to(text, error->size - kTextBegin - 1);
  char* const target = reinterpret_cast<char*>(error) + kTextBegin;  // may be longer than in this version
  std::copy(shown.begin(), shown.end(), target);
  target[shown.size()] = '\0';
  return status;
}

}  // namespace

void clear(gdtslam_error* error) noexcept { tell(error, GDTSLAM_OK, ""); }

gdtslam_status caught(gdtslam_error* error) noexcept {
  try {
    throw;
  } catch (const OutOfMemory& problem) {
    return tell(error, GDTSLAM_OUT_OF_MEMORY, problem.what());
  } catch (const Error& problem) {
    return tell(error, static_cast<gdtslam_status>(problem.code()), problem.what());
  } catch (const std::bad_alloc&) {
    return tell(error, GDTSLAM_OUT_OF_MEMORY, "out of memory");
  } catch (const std::exception& problem) {
    return tell(error, GDTSLAM_FAILED, problem.what());
  } catch (...) {
    return tell(error, GDTSLAM_FAILED, "something was thrown that is no exception of the standard library");
  }
}

void require(const void* pointer, const char* what) {
  if (pointer == nullptr) throw UsageError(std::string(what) + " is NULL");
}

}  // namespace gdtslam::c
