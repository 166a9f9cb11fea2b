/* Preloaded to let calls fail: of the writes, syncs and renames of files, the one of a given number gets an
 * error, or the process is killed before it. Counted from when main of gdtslam begins, in processes that it starts too.
 * Calls that the C library makes by itself are not seen (fwrite).
 * FAILING_KINDS: write, sync, rename, several with commas. FAILING_AT: which of them, from 1; 0 counts only.
 * FAILING_HOW: EIO, ENOSPC or kill-before. FAILING_ON=1: all later ones too, as on a full disk. FAILING_STATE: a file
 * of eight zeros for the count of all processes. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static _Atomic uint64_t own_count;
static _Atomic uint64_t* count = &own_count;
static int is_main = 0;
static const char* kinds = "";
static uint64_t chosen_number = 0;
static int goes_on = 0;
static int error_number = 0; /* 0: a kill */

/* The next definition of a function, which is the C library's. */
#define REAL(type, name, ...)              \
  static type (*real)(__VA_ARGS__) = NULL; \
  if (real == NULL) real = (type(*)(__VA_ARGS__))dlsym(RTLD_NEXT, name)

static void read_settings(void) {
  const char* const chosen = getenv("FAILING_KINDS");
  const char* const at = getenv("FAILING_AT");
  const char* const on = getenv("FAILING_ON");
  const char* const how = getenv("FAILING_HOW");
  const char* const state = getenv("FAILING_STATE");
  if (chosen != NULL) kinds = chosen;
  if (at != NULL) chosen_number = strtoull(at, NULL, 10);
  goes_on = on != NULL && strcmp(on, "1") == 0;
  if (how != NULL && strcmp(how, "EIO") == 0) error_number = EIO;
  if (how != NULL && strcmp(how, "ENOSPC") == 0) error_number = ENOSPC;
  if (state == NULL) return;
  void* const shared =
      mmap(NULL, sizeof *count, PROT_READ | PROT_WRITE, MAP_SHARED, open(state, O_RDWR | O_CLOEXEC), 0);
  if (shared == MAP_FAILED) abort();
  count = shared;
}

static int is_of_program(void) {
  char path[PATH_MAX];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
  if (length <= 0) return 0;
  path[length] = '\0';
  const char* const name = strrchr(path, '/');
  return name != NULL && strncmp(name, "/gdtslam", 8) == 0;
}

static int (*real_main)(int, char**, char**) = NULL;

static int counted_main(int argument_count, char** arguments, char** variables) {
  is_main = 1;
  const int code = real_main(argument_count, arguments, variables);
  is_main = 0;
  return code;
}

// NOLINTNEXTLINE(clang-diagnostic-reserved-identifier, readability-identifier-naming): the C library's name
int __libc_start_main(int (*main)(int, char**, char**), int argument_count, char** arguments, void (*begin)(void),
                      void (*end)(void), void (*end_of_loader)(void), void* stack) {
  REAL(int, "__libc_start_main", int (*)(int, char**, char**), int, char**, void (*)(void), void (*)(void),
       void (*)(void), void*);
  real_main = main;
  if (!is_of_program()) return real(main, argument_count, arguments, begin, end, end_of_loader, stack);
  read_settings();
  return real(counted_main, argument_count, arguments, begin, end, end_of_loader, stack);
}

/* Whether the call fails, which is counted. */
static int fails(const char* kind) {
  if (!is_main || strstr(kinds, kind) == NULL) return 0;
  const uint64_t number = atomic_fetch_add(count, 1) + 1;
  if (chosen_number == 0 || number < chosen_number || (number > chosen_number && !goes_on)) return 0;
  if (error_number == 0) raise(SIGKILL);
  errno = error_number;
  return 1;
}

/* Pipes and terminals do not count. */
static int is_file(int descriptor) {
  const int saved = errno;
  struct stat status;
  const int is_regular = fstat(descriptor, &status) == 0 && (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode));
  errno = saved;
  return is_regular;
}

ssize_t write(int descriptor, const void* data, size_t size) {
  REAL(ssize_t, "write", int, const void*, size_t);
  return is_file(descriptor) && fails("write") ? -1 : real(descriptor, data, size);
}

#define PWRITE(name)                                                          \
  ssize_t name(int descriptor, const void* data, size_t size, off_t offset) { \
    REAL(ssize_t, #name, int, const void*, size_t, off_t);                    \
    return fails("write") ? -1 : real(descriptor, data, size, offset);        \
  }
PWRITE(pwrite)
PWRITE(pwrite64)

int fsync(int descriptor) {
  REAL(int, "fsync", int);
  return fails("sync") ? -1 : real(descriptor);
}

int fdatasync(int descriptor) {
  REAL(int, "fdatasync", int);
  return fails("sync") ? -1 : real(descriptor);
}

int rename(const char* from, const char* to) {
  REAL(int, "rename", const char*, const char*);
  return fails("rename") ? -1 : real(from, to);
}

int renameat2(int old_folder, const char* from, int folder, const char* to, unsigned flags) {
  REAL(int, "renameat2", int, const char*, int, const char*, unsigned);
  return fails("rename") ? -1 : real(old_folder, from, folder, to, flags);
}
