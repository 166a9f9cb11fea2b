// For data that grow for hours: vectors grow by an eighth instead of doubling. Amortised O(1) for each value, with nine
// copies of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace gdtslam {

template <class T>
void push_sparingly(std::vector<T>& values, T value) {
  constexpr std::size_t kLeastRoom = 16;
  if (values.size() == values.capacity()) values.reserve(values.size() + std::max(kLeastRoom, values.size() / 8));
  values.push_back(std::move(value));
}

}  // namespace gdtslam
