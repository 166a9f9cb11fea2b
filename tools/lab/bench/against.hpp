// The rows of two runs of `gdtslam bench` beside each other.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "ratio.hpp"
#include "report.hpp"

namespace gdtslam {

/// A row by its name: the device, group, name and variant.
struct RowName {
  std::string on;
  std::string group;
  std::string name;
  std::string variant;
  friend bool operator==(const RowName&, const RowName&) = default;
};
struct EarlierRow {
  RowName name;
  std::string basis;
  std::vector<double> samples_s;
};
/// One that it was measured on.
struct EarlierDevice {
  std::string on;
  std::string name;
  std::string isa;  ///< of a CPU; else empty
};
/// What `bench --json` wrote. Throws FileError; InputError for what is not of that kind.
struct EarlierBench {
  std::string file;
  std::string version;
  std::vector<EarlierRow> rows;
  std::vector<EarlierDevice> devices{};
};
EarlierBench read_bench(const std::string& file);

struct ComparedRow {
  RowName name;
  TimesRatio times;  ///< as fast now as before
};
struct Against {
  std::string file;
  std::string version;  ///< of the earlier run
  std::vector<ComparedRow> rows;
  std::vector<RowName> only_before;
  std::vector<RowName> only_now;
};
/// Rows of the same name and basis.
Against compare_with(const EarlierBench& before, const std::vector<Measured>& now);

/// A line for each that was another device, or took other instructions, than what now has its name.
std::vector<std::string> other_devices(const EarlierBench& before, const std::vector<Measured>& now);

/// For people, a table below the rows.
std::string against_text(const Against& against);
/// The member "against" of bench.schema.json.
nlohmann::ordered_json against_json(const Against& against);

/// Throws Error (exit 1) that names the rows whose whole interval lies below `least`, or says that there was no row to
/// compare; the machine's limits and peers are not asked. 0 asks for nothing.
void require_at_least(const Against& against, double least);

}  // namespace gdtslam
