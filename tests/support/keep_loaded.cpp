// In programs under AddressSanitizer that draw by OpenGL: nothing is unloaded. When its last display is closed the
// driver's module goes, with what only its own variables pointed to, and LeakSanitizer can no longer name whose it was.
extern "C" int dlclose(void* handle) noexcept;
extern "C" int dlclose(void* /*handle*/) noexcept { return 0; }
