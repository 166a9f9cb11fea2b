# Read by ctest behind the lists of GoogleTest's tests: those that take long, which have their turn where there is little time
# (tools/scripts/draw_tests.py), as long tests of the command have.
foreach(test
    Slices.OfAnySizeGiveTheSameBytes ThreadCount.DoesNotChangeAByteOfTheLargeCases GuardPages.NoKernelTouchesWhatIsNotItsOwn)
  set_tests_properties(${test} PROPERTIES LABELS "unit;long")
endforeach()
