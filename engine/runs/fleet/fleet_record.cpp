#include "fleet_record.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/sha256.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

std::string name_in_atlas(const std::string& log) {
  constexpr std::size_t kLongest = 100;
  constexpr std::size_t kDigits = 12;
  std::string name = log.substr(log.find_last_of('/') + 1).substr(0, kLongest);
  for (char& c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.';
    if (!is_plain && c != '-') c = '_';
  }
  return fmt::format("{}-{}", name, Sha256().update(log).hex().substr(0, kDigits));
}

std::string record_folder(const std::string& atlas, const std::string& log) {
  return fmt::format("{}/logs/{}", atlas, name_in_atlas(log));
}

void write_record(const std::string& atlas, const FleetRecord& record) {
  auto json = nlohmann::ordered_json::object();
  for_each_field(record, [&json](const char* name, const auto& value) { json[name] = value; });
  const std::string folder = record_folder(atlas, record.log);
  make_folder(folder);
  write_json(folder + "/record.json", json);
}

std::optional<FleetRecord> read_record(const std::string& atlas, const std::string& log) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;
  try {
    const auto json = read_json(record_folder(atlas, log) + "/record.json", kMostBytes);
    FleetRecord record;
    for_each_field(record, [&json](const char* name, auto& value) { json.at(name).get_to(value); });
    return record;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace gdtslam
