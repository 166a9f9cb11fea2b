// What `gdtslam bench` prints of its rows: a table for people, of the CPU alone or of a device beside it, and JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rows.hpp"

namespace gdtslam {

/// All rows of one backend, and what it is called.
struct Measured {
  std::string name;  ///< "cpu", "vulkan:0"
  DeviceInfo device;
  std::optional<Isa> isa;  ///< of a CPU
  Basis basis = Basis::kCpu;
  std::vector<BenchRow> rows;
};

/// tests/cli/schemas/bench.schema.json; the first is the CPU.
nlohmann::ordered_json bench_json(const std::vector<Measured>& all);
/// For people, of the CPU alone.
std::string cpu_report(const Measured& cpu);
/// Likewise, a device beside the CPU.
std::string pair_report(const Measured& cpu, const Measured& device);

}  // namespace gdtslam
