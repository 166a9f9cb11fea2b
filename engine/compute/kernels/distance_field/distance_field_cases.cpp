#include "distance_field.hpp"
#include "engine/compute/cases/case_builder.hpp"

namespace gdtslam {
namespace {

/// Squares, half of them within the table and half arbitrary.
KernelCase table_case(const std::string& name, CaseSize size, const std::vector<std::uint16_t>& table) {
  std::vector<std::uint16_t> squares = noise<std::uint16_t>(size, seed_from(name));
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const std::size_t within = squares[i] % table.size();
    squares[i] = i % 2 == 0 ? static_cast<std::uint16_t>(within) : squares[i];
  }
  return make_case<DistanceField>(
      name, {size.width, size.height, size.stride, static_cast<std::uint32_t>(table.size())},
      {size.width, size.height, 1},
      {grid_buffer(size, squares), list_buffer(table), grid_buffer(size, noise<std::uint16_t>(size, 8))});
}

struct TableCase {
  using Kernel = DistanceField;
  CaseSize size;
  std::uint32_t radius = 20;
  [[nodiscard]] std::string name() const { return size_name(size) + " R" + std::to_string(radius); }
  [[nodiscard]] KernelCase make(const std::string& named) const {
    return table_case(named, size, distance_table(radius));
  }
};

/// A random table instead of distances.
KernelCase draw_field(const std::string& name, Random& random) {
  const CaseSize size = draw_size(random);
  const std::uint32_t entries = 1 + draw_count(random, 65535);
  return table_case(name, size, noise<std::uint16_t>({entries, 1, entries}, random.bits()));
}

void add_distance_field_cases(std::vector<KernelCaseSource>& list) {
  for (const std::uint32_t radius : kCaseRadii) {
    for_each_size([&](CaseSize size) { add_case(list, TableCase{size, radius}); });
  }
  for_each_small_size([&](CaseSize size, std::uint32_t turn) {
    add_case(list, TableCase{size, in_turn(kCaseRadii, turn)});
  });
  for (const CaseSize& size : kLongSizes) {
    add_case(list, TableCase{size});
  }
  for (const CaseSize& size : kLargeSizes) {
    add_case(list, TableCase{size}, CaseUse::kLarge);
  }
  add_case(list, TableCase{{1024, 1024, 1024}}, CaseUse::kBenchmark);
}

}  // namespace

CaseGroup DistanceField::cases() { return {add_distance_field_cases, {{&DistanceField::info(), draw_field}}}; }

}  // namespace gdtslam
