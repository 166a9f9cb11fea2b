// libFuzzer's entry for every target: the first argument names it, and the environment tells it to the processes that
// libFuzzer starts itself (-merge, -jobs). `gdtslam_fuzz targets` lists them.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

#include "c_targets.hpp"
#include "log_targets.hpp"
#include "map_targets.hpp"
#include "packed_targets.hpp"
#include "recording_targets.hpp"
#include "run_targets.hpp"
#include "scene_targets.hpp"

namespace {

using gdtslam::fuzz::FuzzTarget;

constexpr const char* kTargetVariable = "GDTSLAM_FUZZ_TARGET";

std::vector<FuzzTarget> all_targets() {
  using namespace gdtslam::fuzz;
  std::vector<FuzzTarget> all;
  for (const std::span<const FuzzTarget> part :
       {std::span<const FuzzTarget>(kLogTargets), std::span<const FuzzTarget>(kRecordingTargets),
        std::span<const FuzzTarget>(kPackedTargets), std::span<const FuzzTarget>(kMapTargets),
        std::span<const FuzzTarget>(kRunTargets), std::span<const FuzzTarget>(kSceneTargets),
        std::span<const FuzzTarget>(kCTargets)}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

const FuzzTarget* target_named(std::string_view name) {
  static const std::vector<FuzzTarget> all = all_targets();
  const auto found = std::find_if(all.begin(), all.end(), [name](const FuzzTarget& t) { return t.name == name; });
  return found == all.end() ? nullptr : &*found;
}

const FuzzTarget* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const std::string_view first = *argc > 1 ? (*argv)[1] : "";
  if (first == "targets") {
    for (const FuzzTarget& target : all_targets())
      std::printf("%.*s\n", static_cast<int>(target.name.size()), target.name.data());
    std::exit(0);
  }
  if (target_named(first) != nullptr) {
    ::setenv(kTargetVariable, (*argv)[1], 1);
    std::rotate(*argv + 1, *argv + 2, *argv + *argc);
    --*argc;
  }
  const char* const name = std::getenv(kTargetVariable);
  chosen = name == nullptr ? nullptr : target_named(name);
  if (chosen == nullptr) {
    static_cast<void>(
        std::fprintf(stderr, "the first argument is the name of a target; `%s targets` lists them\n", **argv));
    std::exit(2);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  chosen->read(std::as_bytes(std::span(data, size)));
  return 0;
}
