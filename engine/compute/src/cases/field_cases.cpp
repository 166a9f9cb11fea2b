#include "cases/case_builder.hpp"
#include "gdtslam/compute/kernels/distance_field.hpp"

namespace gdtslam {
namespace {

void add_field(std::vector<KernelCaseSource>& list, CaseSize size, std::uint32_t radius, bool benchmark) {
  const std::string name = size_name(size) + " R" + std::to_string(radius);
  add_case<DistanceField>(
      list, name,
      [=](const std::string& named) {
        std::vector<std::uint16_t> squares = noise<std::uint16_t>(size, seed_from(named));
        for (std::size_t i = 0; i < squares.size(); ++i) {  // half within the table, half anything
          const std::uint32_t within = squares[i] % (radius * radius + 1);
          squares[i] = i % 2 == 0 ? static_cast<std::uint16_t>(within) : squares[i];
        }
        const std::vector<std::uint16_t> table = distance_table(radius);
        return make_case<DistanceField>(
            named, {size.width, size.height, size.stride, static_cast<std::uint32_t>(table.size())},
            {size.width, size.height, 1},
            {grid_buffer(size, squares), list_buffer(table), grid_buffer(size, noise<std::uint16_t>(size, 8))});
      },
      benchmark);
}

}  // namespace

void add_field_cases(std::vector<KernelCaseSource>& list) {
  for (const CaseSize& size : kCaseSizes) {
    for (const std::uint32_t radius : {1U, 20U, 255U}) {
      add_field(list, size, radius, false);
    }
  }
  add_field(list, {1024, 1024, 1024}, 20, true);
}

}  // namespace gdtslam
