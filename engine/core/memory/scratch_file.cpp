#include "scratch_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

std::string folder_meant(const std::string& folder) {
  if (!folder.empty()) return folder;
  const char* const variable = std::getenv("TMPDIR");
  return variable != nullptr && *variable != '\0' ? variable : "/var/tmp";
}

// A file without a name, so that a killed process leaves nothing. If the file system has no such files, the name is
// removed at once.
int open_unnamed(const std::string& folder) {
  const int unnamed = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (unnamed >= 0) return unnamed;
  std::string name = folder + "/gdtslam-scratch-XXXXXX";
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor >= 0) ::unlink(name.c_str());
  return descriptor;
}

[[noreturn]] void fail(const std::string& folder, const std::string& what) {
  const std::string why = std::system_category().message(errno);
  throw FileError(
      folder, what + ": " + why + "; what is not needed at once is kept in a file there (TMPDIR names another folder)");
}

}  // namespace

ScratchFile::ScratchFile(const std::string& folder)
    : folder_(folder_meant(folder)), descriptor_(open_unnamed(folder_)) {
  if (descriptor_ < 0) fail(folder_, "takes no file");
}

ScratchFile::~ScratchFile() { ::close(descriptor_); }

void ScratchFile::write(std::uint64_t place, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(place));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(folder_, "cannot be written to");
    place += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void ScratchFile::read(std::uint64_t place, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t got = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(place));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail(folder_, "cannot be read from");
    place += static_cast<std::uint64_t>(got);
    bytes = bytes.subspan(static_cast<std::size_t>(got));
  }
}

}  // namespace gdtslam
