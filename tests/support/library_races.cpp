// In programs under ThreadSanitizer that draw. What libraries that are not instrumented do to agree among their threads
// cannot be seen, and looks like no agreement at all: Mesa's software driver counts who is the last to need a fence,
// the C library locks its time zone (Cairo asks for the time). Only what has these in it is left out.
extern "C" const char* __tsan_default_suppressions();  // NOLINT(clang-diagnostic-reserved-identifier)
extern "C" const char* __tsan_default_suppressions() { return "race:swrast_dri.so\nrace:tzset_internal\n"; }
