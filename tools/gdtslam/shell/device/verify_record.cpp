#include "verify_record.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/transaction/folder_lock.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 2;

// An empty list for a file that is missing, cut or of another format: then nothing counts as verified.
Json read_list(const std::string& file) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
  Json root;
  try {
    root = read_json(file, kMostBytes);
  } catch (const Error&) {
    return Json::array();
  }
  if (!root.is_object() || !root.contains("format") || root["format"] != kFormat || !root.contains("results") ||
      !root["results"].is_array()) {
    return Json::array();
  }
  return root["results"];
}

bool has_text(const Json& entry, const char* key, const std::string& text) {
  return entry.is_object() && entry.contains(key) && entry[key] == text;
}

bool is_of(const Json& entry, const VulkanDeviceInfo& device) {
  return has_text(entry, "device", device.name) && has_text(entry, "driver", device.driver) &&
         has_text(entry, "uuid", device.uuid);
}

std::optional<std::uint64_t> count_in(const Json& entry, const char* key) {
  if (!entry.contains(key) || !entry[key].is_number_unsigned()) return std::nullopt;
  return entry[key].get<std::uint64_t>();
}

std::optional<std::string> text_in(const Json& entry, const char* key) {
  if (!entry.contains(key) || !entry[key].is_string()) return std::nullopt;
  return entry[key].get<std::string>();
}

std::optional<VerifyRecord> record_in(const Json& entry) {
  const std::optional<std::uint64_t> cases = count_in(entry, "cases");
  const std::optional<std::uint64_t> logs = count_in(entry, "logs");
  const std::optional<std::uint64_t> differences = count_in(entry, "differences");
  const std::optional<std::string> date = text_in(entry, "date");
  const std::optional<std::string> failure = text_in(entry, "failure");
  if (!cases || !logs || !differences || !date || !failure) return std::nullopt;
  return VerifyRecord{*date, *cases, *logs, *differences, *failure};
}

}  // namespace

std::string digest_of(std::span<const ShaderModule> shaders) {
  Sha256 digest;
  for (const ShaderModule& shader : shaders) {
    digest.update(shader.kernel).update(std::string_view("\n")).update(std::as_bytes(shader.spirv));
  }
  return digest.hex();
}

VerifyRecords::VerifyRecords(std::string folder, std::string shaders)
    : folder_(std::move(folder)), shaders_(std::move(shaders)) {}

std::string VerifyRecords::file() const { return folder_ + "/verify.json"; }

std::optional<VerifyRecord> VerifyRecords::find(const VulkanDeviceInfo& device) const {
  if (folder_.empty()) return std::nullopt;
  for (const Json& entry : read_list(file())) {
    if (is_of(entry, device) && has_text(entry, "version", GDTSLAM_VERSION) && has_text(entry, "shaders", shaders_)) {
      return record_in(entry);
    }
  }
  return std::nullopt;
}

void VerifyRecords::keep(const VulkanDeviceInfo& device, const VerifyRecord& record) const {
  if (folder_.empty()) return;
  const FolderLock lock(folder_, FolderLock::Taken::kWait);  // another verification may keep what it found meanwhile
  Json results = Json::array();
  for (Json& entry : read_list(file())) {
    if (!is_of(entry, device)) results.push_back(std::move(entry));
  }
  results.push_back({{"device", device.name},
                     {"uuid", device.uuid},
                     {"driver", device.driver},
                     {"version", GDTSLAM_VERSION},
                     {"shaders", shaders_},
                     {"date", record.date},
                     {"cases", record.cases},
                     {"logs", record.logs},
                     {"differences", record.differences},
                     {"failure", record.failure}});
  write_json(file(), {{"format", kFormat}, {"results", results}});
}

VerifyRecords user_records() { return {cache_folder().path, digest_of(shader_modules())}; }

}  // namespace gdtslam
