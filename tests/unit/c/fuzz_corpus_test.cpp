// The corpus of the C interface's fuzz target, replayed through the shared library.
#include "fuzz/c_targets.hpp"
#include "fuzz/replay.hpp"

namespace gdtslam::fuzz {
namespace {

class CCorpus : public testing::TestWithParam<FuzzTarget> {};

TEST_P(CCorpus, EndsInAStatus) { replay_corpus(GetParam()); }

INSTANTIATE_TEST_SUITE_P(C, CCorpus, testing::ValuesIn(kCTargets), name_of_test);

}  // namespace
}  // namespace gdtslam::fuzz
