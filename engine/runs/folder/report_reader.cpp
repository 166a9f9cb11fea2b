#include "report_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/io/json_file.hpp"
#include "gdtslam/core/error.hpp"
#include "run_report.hpp"

namespace gdtslam {
namespace {

bool is_whole_value(const ReportReader::Value& value) { return value.is_number_unsigned(); }
bool is_number_value(const ReportReader::Value& value) { return value.is_number(); }
bool is_truth_value(const ReportReader::Value& value) { return value.is_boolean(); }
bool is_text_value(const ReportReader::Value& value) { return value.is_string(); }
bool is_list_value(const ReportReader::Value& value) { return value.is_array(); }

}  // namespace

ReportReader::ReportReader(std::string file, std::string advice, Value report)
    : file_(std::move(file)),
      advice_(std::move(advice)),
      report_(std::make_shared<const Value>(std::move(report))),
      object_(report_.get()) {
  if (!object_->is_object()) fail("does not hold a JSON object");
}

const ReportReader::Value& ReportReader::at(const char* key) const {
  const auto found = object_->find(key);
  if (found == object_->end()) fail(fmt::format("has no '{}{}'", path_, key));
  return *found;
}

const ReportReader::Value& ReportReader::at(const char* key, IsOfType is_of_type, const char* type) const {
  const Value& value = at(key);
  if (!is_of_type(value)) fail(key, fmt::format("is not {}", type));
  return value;
}

std::uint64_t ReportReader::whole(const char* key) const {
  return at(key, is_whole_value, "a whole number").get<std::uint64_t>();
}

std::size_t ReportReader::index(const char* key, std::uint64_t end) const {
  const std::uint64_t value = whole(key);
  if (value >= end) fail(key, fmt::format("names a scan that is none of its {}", end));
  return static_cast<std::size_t>(value);
}

double ReportReader::number(const char* key) const { return at(key, is_number_value, "a number").get<double>(); }

std::vector<double> ReportReader::numbers_in(const Value& value, const char* key, std::size_t count,
                                             double most) const {
  const auto is_within = [most](const Value& entry) {
    return entry.is_number() && std::fabs(entry.get<double>()) <= most;  // false for NaN too
  };
  if (!value.is_array() || value.size() != count || !std::all_of(value.begin(), value.end(), is_within)) {
    fail(key, fmt::format("is not {} numbers from {:g} to {:g}", count, -most, most));
  }
  return value.get<std::vector<double>>();
}

std::vector<double> ReportReader::numbers(const char* key, std::size_t count, double most) const {
  return numbers_in(at(key), key, count, most);
}

std::vector<std::vector<double>> ReportReader::rows(const char* key, std::size_t count, double most) const {
  std::vector<std::vector<double>> rows;
  for (const Value& row : list(key)) rows.push_back(numbers_in(row, key, count, most));
  return rows;
}

std::optional<double> ReportReader::number_or_null(const char* key) const {
  return at(key).is_null() ? std::nullopt : std::optional(number(key));
}

bool ReportReader::has(const char* key) const { return object_->contains(key); }

bool ReportReader::truth(const char* key) const { return at(key, is_truth_value, "true or false").get<bool>(); }

std::string ReportReader::text(const char* key) const { return at(key, is_text_value, "a text").get<std::string>(); }

GridGeometry ReportReader::geometry(const char* key) const {
  const ReportReader grid = section(key);
  const std::vector<double> origin_m = grid.numbers("origin_m", 2, std::numeric_limits<double>::max());
  const auto side = [&grid](const char* name) {
    const std::uint64_t cells = grid.whole(name);
    if (cells > std::numeric_limits<std::int32_t>::max()) grid.fail(name, "is more cells than a grid has");
    return static_cast<std::int32_t>(cells);
  };
  return {.resolution_m = grid.number("resolution_m"),
          .origin_x_m = origin_m[0],
          .origin_y_m = origin_m[1],
          .width = side("width"),
          .height = side("height")};
}

std::vector<std::string> ReportReader::texts(const char* key) const {
  std::vector<std::string> values;
  for (const Value& value : list(key)) {
    if (!value.is_string()) fail(key, "is not a list of texts");
    values.push_back(value.get<std::string>());
  }
  if (values.empty()) fail(key, "is empty");
  return values;
}

std::vector<std::size_t> ReportReader::indices(const char* key, const char* member, std::uint64_t end) const {
  std::vector<std::size_t> values;
  for (const Value& entry : list(key)) {
    const bool is_member = member != nullptr && entry.is_object() && entry.contains(member);
    const Value& value = is_member ? entry.at(member) : entry;
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= end) {
      fail(key, fmt::format("names a scan that is none of its {}", end));
    }
    values.push_back(value.get<std::size_t>());
  }
  return values;
}

std::vector<ReportFile> ReportReader::files(const char* key) const {
  std::vector<ReportFile> rows;
  for (const Value& row : list(key)) {
    try {
      rows.push_back({row.at(0).get<std::string>(), row.at(1).get<std::uint64_t>(), row.at(2).get<std::string>()});
    } catch (const Value::exception&) {
      fail(key, "is not a list of names, bytes and hashes");
    }
  }
  return rows;
}

const ReportReader::Value& ReportReader::list(const char* key) const { return at(key, is_list_value, "a list"); }

ReportReader ReportReader::section(const char* key) const { return within(at(key), key); }

std::vector<ReportReader> ReportReader::entries(const char* key) const {
  std::vector<ReportReader> readers;
  for (const Value& entry : list(key)) readers.push_back(within(entry, fmt::format("{}[{}]", key, readers.size())));
  return readers;
}

ReportReader ReportReader::within(const Value& object, const std::string& name) const {
  if (!object.is_object()) fail(name.c_str(), "is not an object");
  ReportReader reader = *this;
  reader.object_ = &object;
  reader.path_ = path_ + name + '.';
  return reader;
}

void ReportReader::fail(const std::string& fault) const { throw InputError({file_, 0}, fault + advice_); }

void ReportReader::fail(const char* key, const std::string& fault) const {
  fail(fmt::format("'{}{}' {}", path_, key, fault));
}

ReportReader read_report(const std::string& file, const std::string& folder) {
  const std::string advice = kMapAgain + folder;
  ReportReader report(file, advice, read_json(file, kMostReportBytes, advice));
  const std::uint64_t format = report.whole("format");
  if (format != kReportVersion) {
    report.fail(fmt::format("has format {}, and this program reads format {}", format, kReportVersion));
  }
  return report;
}

}  // namespace gdtslam
