"""Each test that needs data that are not part of the project has a twin on simulated ones, so that nothing skips in silence:
TWINS names it, and it never skips for want of data."""

import pathlib
import re
import unittest

TESTS = pathlib.Path(__file__).resolve().parents[1]

TWINS = {
    "RawOdometryTest.ScoresThePublishedError": "RawOdometrySimulated.ScoresTheErrorThatItsWheelsMake",
    "RealLogTest.MapsWithinTheBoundsInUnderTenSecondsOfProcessorTime": "SampleLogTest.MapsWithinTighterBoundsThanTheRealLogs",
    "RealLogThinned.EverySecondScanOfCsailIsMappedByEveryMatcher":
        "SampleLogTest.EverySecondScanIsMappedWhereTheOdometryTurnsBy85DegreesInOneStep",
    "RealLogRule.TheMergeRuleAsPrintedMissesTheBoundOnIntel": "SampleLogRule.TheMergeRuleAsPrintedMissesTheBound",
    "RealLogWithLoops.IsWithinTheBounds": "SampleLogWithLoops.IsWithinTighterBoundsThanTheRealLogs",
    "HospitalWithLoops.HoldsWhatItsLoopsSay": "HeldLoops.AreThoseThatAreOnBetweenKeptKeyframes",
    "IntelWithoutOdometryWithLoops.IsNotLost": "KeyframeSteps.AMatchThatLeapsFromAMotionThatGoesOnMayBeWrongByAsMuch",
    "SparseLogWithLoops.IsNotLost": "SampleLogWithLoops.IsNotLostWhereScansAreAsSparse",
    "LocalizeOccupancy.FindsScansInAMapOfARealBuilding": "localize_in_an_occupancy_map",
    "MapOfKeyframesTest.APublicLogGivesTheSameMap": "MapOfKeyframesTest.WholeMillimetresGiveTheSameMap",
    "RelationsRealData.HaveTheirKnownCounts": "Relations.ReadsRows",
    "CarmenRealData.IntelHasItsKnownCounts": "CarmenSample.HasItsKnownCounts",
    "BagRealData.TheSameDriveAsItsCarmenLog": "Bag.ScansGetTheOdometryOfTheirOwnStampInEveryPacking",
    "BagRealData.AnIndexThatStatesAWrongLength": "Bag.AnIndexOfAWrongLengthIsPassedByItsEntries",
    "RealBeamTimes.ARealLaserThatSweepsInMillisecondsIsNotAccused": "SweptLog.MapPutsReversedTimesRight",
    "HokuyoBeamTimes.AreFoundFromItsScansWhateverIsSaid": "BeamTimes.TheSweepIsThatOfTheLaserWhateverTheLogSays",
    "RecordingsRealData.BagsOfRos2AreReadWhole": "SqliteBags.FilesOfAFolderFollowEachOther",
    "OccupancyMapFileRealData.WillowGarageLoads": "OccupancyMapFile.PngHasTheSameMap",
    "CertifiedIntel.NoBoundLiesAboveWhatBruteForceFinds": "CertifiedSample.NoBoundLiesAboveWhatBruteForceFinds",
    "doctor_of_real_bags": "doctor_of_several_lasers",
    "tilting_laser_of_others": "nodding_tilt",
}
# The scenarios of the command that look for such data: they are told by the folder that their file names.
SCENARIOS = ("doctor_of_real_bags", "tilting_laser_of_others")


def tests_of(text, is_python):
    """The name and the body of each test of a file."""
    start = re.compile(r"^def (\w+)\(" if is_python else r"^TEST(?:_F|_P)?\((\w+), (\w+)\)", re.MULTILINE)
    found = list(start.finditer(text))
    ends = [match.start() for match in found[1:]] + [len(text)]
    return {".".join(match.groups()): text[match.end():end] for match, end in zip(found, ends)}


def all_tests():
    tests = {}
    for file in sorted([*TESTS.glob("*/*/*.cpp"), *TESTS.glob("cli/scenario_*.py")]):
        tests |= tests_of(file.read_text(encoding="utf-8"), file.suffix == ".py")
    return tests


def needs_data(tests, name):
    return "GDTSLAM_REAL_DATA(" in tests[name] or name in SCENARIOS


class Twins(unittest.TestCase):
    def test_each_test_of_real_data_has_one_that_never_skips(self):
        tests = all_tests()
        self.assertGreater(len(tests), 1000, "these are not all tests")
        real = {name for name in tests if needs_data(tests, name)}
        self.assertEqual(real, set(TWINS), "a test without a twin, or a twin of no test")
        for name, twin in TWINS.items():
            self.assertIn(twin, tests, f"the twin of {name}")
            self.assertFalse(needs_data(tests, twin), f"the twin of {name} needs data itself")

    def test_no_scenario_reads_the_folder_of_data_that_is_not_listed(self):
        readers = {file.name for file in TESTS.glob("cli/scenario_*.py") if '"shared" / "data"' in file.read_text(encoding="utf-8")}
        self.assertEqual(readers, {"scenario_doctor.py", "scenario_tilt3d.py"})


if __name__ == "__main__":
    unittest.main()
