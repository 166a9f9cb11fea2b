// The corpora of the fuzz targets of runs, scenes and what commands keep, replayed with every compiler.
#include "fuzz/replay.hpp"
#include "fuzz/run_targets.hpp"
#if __has_include("gdtslam/sim/scene.hpp")  // the simulator may be left out of a build
#include "fuzz/scene_targets.hpp"
#endif

namespace gdtslam::fuzz {
namespace {

class RunCorpus : public testing::TestWithParam<FuzzTarget> {};

TEST_P(RunCorpus, EndsInFilesOrATypedError) { replay_corpus(GetParam()); }

INSTANTIATE_TEST_SUITE_P(Runs, RunCorpus, testing::ValuesIn(kRunTargets), name_of_test);
#if __has_include("gdtslam/sim/scene.hpp")
INSTANTIATE_TEST_SUITE_P(Scenes, RunCorpus, testing::ValuesIn(kSceneTargets), name_of_test);
#endif

}  // namespace
}  // namespace gdtslam::fuzz
