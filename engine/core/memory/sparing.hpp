// For what grows for hours and stays: vectors with room for an eighth more than they hold, where others double. O(1)
// for each value in the mean, with nine copies of it.
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
