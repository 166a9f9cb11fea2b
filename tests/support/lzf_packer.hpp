// Packs bytes as LibLZF's format has them, to test what unpacks them: greedy, with the last place of each three bytes.
#pragma once

#include <string>
#include <string_view>

namespace gdtslam::test {

std::string pack_lzf(std::string_view data);

}  // namespace gdtslam::test
