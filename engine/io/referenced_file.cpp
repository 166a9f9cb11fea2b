#include "referenced_file.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "engine/core/ascii.hpp"
#include "message_text.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

bool is_below(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

}  // namespace

std::string extension_of(const std::string& path) { return in_small_letters(fs::path(path).extension().string()); }

std::string referenced_path(const std::string& referrer, const std::string& name) {
  const fs::path path(name);
  return (fs::path(referrer).parent_path() / (path.is_absolute() ? path.filename() : path)).string();
}

std::string fault_of_reference(const std::string& referrer, const std::string& name) {
  constexpr std::size_t kMostBytes = 4096;
  // Messages quote the path, so it must be readable text of one line.
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; };
  if (name.size() > kMostBytes || std::any_of(name.begin(), name.end(), is_control)) {
    return in_quotes(name) + " is no name of a file";
  }
  const fs::path stated(name);
  const fs::path relative = stated.is_absolute() ? stated.filename() : stated;
  std::string leads_out =
      in_quotes(name) + " leads out of the folder of this file; put what it names into that folder and give its name";
  if (relative.empty() || std::find(relative.begin(), relative.end(), "..") != relative.end()) {
    return leads_out;
  }
  std::error_code error;
  const fs::path path = fs::canonical(referenced_path(referrer, name), error);
  if (error && stated.is_absolute()) {
    return in_quotes(name) +
           " is an absolute name, of which the last part counts; no such file lies in the folder of this file";
  }
  if (error) return {};  // opening it reports the missing file
  const fs::path parent = fs::path(referrer).parent_path();
  const fs::path folder = fs::canonical(parent.empty() ? fs::path(".") : parent, error);
  if (error || !is_below(path, folder)) return leads_out;
  return fs::is_regular_file(path, error) ? std::string() : in_quotes(name) + " is no regular file";
}

}  // namespace gdtslam
