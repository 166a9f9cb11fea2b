// The corpora of the fuzz targets of io, replayed with every compiler.
#include "fuzz/log_targets.hpp"
#include "fuzz/map_targets.hpp"
#include "fuzz/packed_targets.hpp"
#include "fuzz/recording_targets.hpp"
#include "fuzz/replay.hpp"

namespace gdtslam::fuzz {
namespace {

class FuzzCorpus : public testing::TestWithParam<FuzzTarget> {};

TEST_P(FuzzCorpus, EndsInRecordsOrATypedError) { replay_corpus(GetParam()); }

INSTANTIATE_TEST_SUITE_P(Logs, FuzzCorpus, testing::ValuesIn(kLogTargets), name_of_test);
INSTANTIATE_TEST_SUITE_P(Recordings, FuzzCorpus, testing::ValuesIn(kRecordingTargets), name_of_test);
INSTANTIATE_TEST_SUITE_P(Packed, FuzzCorpus, testing::ValuesIn(kPackedTargets), name_of_test);
INSTANTIATE_TEST_SUITE_P(Maps, FuzzCorpus, testing::ValuesIn(kMapTargets), name_of_test);

}  // namespace
}  // namespace gdtslam::fuzz
