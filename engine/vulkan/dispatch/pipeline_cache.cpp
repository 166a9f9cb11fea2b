#include "pipeline_cache.hpp"

#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

/// Ours, before what the driver gave: a driver need not survive a damaged file.
struct FileHeader {
  std::array<char, 8> magic{'G', 'D', 'T', 'P', 'I', 'P', 'E', '1'};
  std::uint64_t bytes = 0;
  std::uint64_t hash = 0;
};

/// Larger is no cache of ours.
constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20U;

/// FNV-1a.
std::uint64_t hash_of(std::span<const std::uint8_t> data) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const std::uint8_t byte : data) {
    hash = (hash ^ byte) * 1099511628211ULL;
  }
  return hash;
}

std::string file_name(const vk::PhysicalDeviceProperties& properties) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string name = "pipelines-";
  for (const std::uint8_t byte : properties.pipelineCacheUUID) {
    name += kDigits[byte >> 4U];
    name += kDigits[byte & 15U];
  }
  return name + "-" + std::to_string(properties.vendorID) + "-" + std::to_string(properties.deviceID) + "-" +
         std::to_string(properties.driverVersion) + "-gdtslam";
}

/// Whether the driver's own header names this device.
bool is_for(const vk::PhysicalDeviceProperties& properties, const std::vector<std::uint8_t>& data) {
  VkPipelineCacheHeaderVersionOne header;
  if (data.size() < sizeof(header)) {
    return false;
  }
  std::memcpy(&header, data.data(), sizeof(header));
  return header.headerSize >= sizeof(header) && header.headerVersion == VK_PIPELINE_CACHE_HEADER_VERSION_ONE &&
         header.vendorID == properties.vendorID && header.deviceID == properties.deviceID &&
         std::memcmp(header.pipelineCacheUUID, properties.pipelineCacheUUID.data(), VK_UUID_SIZE) == 0;
}

/// The driver's data from a file; empty when there is none that can be trusted.
std::vector<std::uint8_t> read_file(const std::string& path, const vk::PhysicalDeviceProperties& properties) {
  std::ifstream file(path, std::ios::binary);
  FileHeader header;
  if (!file.read(reinterpret_cast<char*>(&header), sizeof(header)) || header.magic != FileHeader{}.magic ||
      header.bytes > kMostBytes) {
    return {};
  }
  std::error_code error;
  if (fs::file_size(path, error) != sizeof(header) + header.bytes || error) {
    return {};
  }
  std::vector<std::uint8_t> data(header.bytes);
  if (!file.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(data.size())) ||
      hash_of(data) != header.hash || !is_for(properties, data)) {
    return {};
  }
  return data;
}

bool write_file(const std::string& path, const std::vector<std::uint8_t>& data) {
  std::error_code error;
  fs::create_directories(fs::path(path).parent_path(), error);
  const std::string temporary = path + "." + std::to_string(getpid()) + ".part";
  FileHeader header;
  header.bytes = data.size();
  header.hash = hash_of(data);
  bool is_written = false;
  {
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(&header), sizeof(header));
    file.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
    file.close();
    is_written = static_cast<bool>(file);
  }
  if (is_written) {
    fs::rename(temporary, path, error);
    is_written = !error;
  }
  if (!is_written) {
    fs::remove(temporary, error);
  }
  return is_written;
}

}  // namespace

PipelineCache::PipelineCache(const Device& device, const std::string& folder)
    : path_(folder.empty() ? "" : folder + "/" + file_name(device.properties())), handle_(nullptr) {
  std::vector<std::uint8_t> data;
  if (!path_.empty()) {
    data = read_file(path_, device.properties());
  }
  was_loaded_ = !data.empty();
  vk::PipelineCacheCreateInfo info;
  info.initialDataSize = data.size();
  info.pInitialData = data.data();
  handle_ = vk::raii::PipelineCache(device.handle(), info);
}

bool PipelineCache::save() const { return path_.empty() || write_file(path_, handle_.getData()); }

}  // namespace gdtslam
