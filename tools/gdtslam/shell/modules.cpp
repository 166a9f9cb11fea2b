#include "modules.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <string_view>
#include <system_error>

#include "console.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// A library of ours that was built beside another program has other types under the same names.
void check_version(const Module& module, const std::string& file) {
  if (std::string_view(module.version) == GDTSLAM_VERSION) return;
  throw UnavailableError(printable(file) + " is of gdtslam " + module.version +
                         ", this program of " GDTSLAM_VERSION "; install the command as a whole");
}

std::string loader_message() {
  const char* const text = ::dlerror();
  return text == nullptr ? "the loader does not say why" : printable(text);
}

}  // namespace

std::string module_file(const std::string& command) {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  return (program.parent_path() / GDTSLAM_MODULE_FOLDER / (command + ".so")).lexically_normal().string();
}

const Module& open_module(const std::string& command) {
  const std::string file = module_file(command);
  std::error_code ignored;  // what cannot be asked about is not there
  if (!std::filesystem::exists(file, ignored)) {
    throw UnavailableError("'" + command + "' is not installed: there is no " + printable(file) +
                           "; install the command as a whole");
  }
  // Never closed: VTK and OpenGL drivers do not come back after it.
  void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  const void* const entry = library == nullptr ? nullptr : ::dlsym(library, "gdtslam_module");
  if (entry == nullptr) {
    throw UnavailableError("'" + command + "' cannot be loaded: " + loader_message() +
                           "; install what is missing (docs/dependencies.md)");
  }
  const Module& module = *static_cast<const Module*>(entry);
  check_version(module, file);
  return module;
}

}  // namespace gdtslam
