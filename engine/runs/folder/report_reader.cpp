#include "report_reader.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/io/json_file.hpp"
#include "gdtslam/core/error.hpp"
#include "run_report.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

ReportReader::ReportReader(std::string file, std::string folder, std::shared_ptr<const Json> report)
    : file_(std::move(file)), folder_(std::move(folder)), report_(std::move(report)), object_(report_.get()) {
  if (!object_->is_object()) fail("holds no JSON object");
}

std::uint64_t ReportReader::whole(const char* key) const {
  const Json& value = at(key);
  if (!value.is_number_unsigned()) fail(fmt::format("{} is no whole number", named(key)));
  return value.get<std::uint64_t>();
}

std::size_t ReportReader::index(const char* key, std::uint64_t end) const {
  const std::uint64_t value = whole(key);
  if (value >= end) fail(fmt::format("{} names a scan that is none of its {}", named(key), end));
  return static_cast<std::size_t>(value);
}

double ReportReader::number(const char* key) const {
  const Json& value = at(key);
  if (!value.is_number()) fail(fmt::format("{} is no number", named(key)));
  return value.get<double>();
}

std::optional<double> ReportReader::number_or_null(const char* key) const {
  return at(key).is_null() ? std::nullopt : std::optional(number(key));
}

bool ReportReader::truth(const char* key) const {
  const Json& value = at(key);
  if (!value.is_boolean()) fail(fmt::format("{} is neither true nor false", named(key)));
  return value.get<bool>();
}

std::string ReportReader::text(const char* key) const {
  const Json& value = at(key);
  if (!value.is_string()) fail(fmt::format("{} is no text", named(key)));
  return value.get<std::string>();
}

GridGeometry ReportReader::geometry(const char* key) const {
  const std::string fault = fmt::format("{} is no geometry of a grid", named(key));
  const auto side_of = [this, &fault](const Json& side) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
    if (!side.is_number_unsigned() || side.get<std::uint64_t>() > kMost) fail(fault);
    return static_cast<std::int32_t>(side.get<std::uint64_t>());
  };
  try {
    const Json& value = at(key);
    const Json& origin = value.at("origin_m");
    return {.resolution_m = value.at("resolution_m").get<double>(),
            .origin_x_m = origin.at(0).get<double>(),
            .origin_y_m = origin.at(1).get<double>(),
            .width = side_of(value.at("width")),
            .height = side_of(value.at("height"))};
  } catch (const Json::exception&) {
    fail(fault);
  }
}

std::vector<std::string> ReportReader::texts(const char* key) const {
  std::vector<std::string> list;
  for (const Json& value : list_of(key)) {
    if (!value.is_string()) fail(fmt::format("{} is no list of texts", named(key)));
    list.push_back(value.get<std::string>());
  }
  if (list.empty()) fail(fmt::format("{} is empty", named(key)));
  return list;
}

bool ReportReader::has(const char* key) const { return object_->contains(key); }

bool ReportReader::has_member(const char* key, const char* member, const char* text) const {
  const Json& object = at(key);
  if (!object.is_object()) fail(fmt::format("{} is no object", named(key)));
  return object.contains(member) && object.at(member) == text;
}

std::vector<std::size_t> ReportReader::indices(const char* key, const char* member, std::uint64_t end) const {
  std::vector<std::size_t> list;
  for (const Json& entry : list_of(key)) {
    const bool is_member = member != nullptr && entry.is_object() && entry.contains(member);
    const Json& value = is_member ? entry.at(member) : entry;
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= end) {
      fail(fmt::format("{} names a scan that is none of its {}", named(key), end));
    }
    list.push_back(value.get<std::size_t>());
  }
  return list;
}

std::vector<ReportFile> ReportReader::files(const char* key) const {
  std::vector<ReportFile> list;
  for (const Json& row : list_of(key)) {
    try {
      list.push_back({row.at(0).get<std::string>(), row.at(1).get<std::uint64_t>(), row.at(2).get<std::string>()});
    } catch (const Json::exception&) {
      fail(fmt::format("{} is no list of names, bytes and hashes", named(key)));
    }
  }
  return list;
}

ReportReader ReportReader::section(const char* key) const { return within(at(key), key); }

std::vector<ReportReader> ReportReader::entries(const char* key) const {
  const Json& list = list_of(key);
  std::vector<ReportReader> readers;
  readers.reserve(list.size());
  for (const Json& entry : list) readers.push_back(within(entry, fmt::format("{}[{}]", key, readers.size())));
  return readers;
}

ReportReader ReportReader::within(const Json& object, const std::string& name) const {
  if (!object.is_object()) fail(fmt::format("{} is no object", named(name.c_str())));
  ReportReader reader = *this;
  reader.object_ = &object;
  reader.path_ = path_ + name + '.';
  return reader;
}

const Json& ReportReader::at(const char* key) const {
  const auto found = object_->find(key);
  if (found == object_->end()) fail(fmt::format("has no {}", named(key)));
  return *found;
}

const Json& ReportReader::list_of(const char* key) const {
  const Json& value = at(key);
  if (!value.is_array()) fail(fmt::format("{} is no list", named(key)));
  return value;
}

std::string ReportReader::named(const char* key) const { return fmt::format("'{}{}'", path_, key); }

void ReportReader::fail(const std::string& fault) const { throw InputError({file_, 0}, fault + kMapAgain + folder_); }

ReportReader read_report(const std::string& file, const std::string& folder) {
  const std::string advice = kMapAgain + folder;
  ReportReader report(file, folder, std::make_shared<const Json>(read_json(file, kMostReportBytes, advice)));
  const std::uint64_t format = report.whole("format");
  if (format == kReportVersion) return report;
  throw InputError({file, 0},
                   fmt::format("has format {}, and this program reads format {}{}", format, kReportVersion, advice));
}

}  // namespace gdtslam
