/* Preloaded to let calls fail: of the calls of some kinds, the one of a given number gets an error, moves fewer bytes
 * than it was asked to, or is the last that the process makes. Counted from when main begins, in gdtslam and in
 * processes of gdtslam that it starts; not in other programs, and of files only what lies below the named folders, so
 * neither shared libraries nor fonts nor what drivers keep. Calls that the C library makes by itself are not seen
 * (fread, fwrite), nor are stat and readdir.
 * FAILING_KINDS: open, read, write, sync, close, rename, unlink, mkdir, link, truncate, map, or change
 * (before and after which a kill can tell), several with commas. FAILING_AT: which of them, from 1; 0 counts only.
 * FAILING_HOW: EIO, ENOSPC, EINTR, EAGAIN, ENOMEM, EROFS, short, kill-before, kill-after. FAILING_ON=1: all later ones
 * too, as on a full disk. FAILING_BELOW: absolute folders with colons; unset: every file. FAILING_STATE: a file of
 * zeros, as large as CallState, for the counts of all processes. */
#include "failing_calls.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

static const char* const kKindNames[kKinds] = {"open",   "read",  "write", "sync",     "close", "rename",
                                               "unlink", "mkdir", "link",  "truncate", "map",   "change"};
static const struct {
  const char* name;
  int number;
} kErrors[] = {{"EIO", EIO},       {"ENOSPC", ENOSPC}, {"EINTR", EINTR},
               {"EAGAIN", EAGAIN}, {"ENOMEM", ENOMEM}, {"EROFS", EROFS}};

static struct CallState own_state;
static struct CallState* state = &own_state;
static int is_main = 0;
static unsigned chosen_kinds = 0;
static uint64_t chosen_number = 0;
static int goes_on = 0;
static int error_number = 0; /* 0: one of the three below */
static int is_short = 0;
static int is_kill_after = 0;
static const char* folders = NULL;

/* The next definition of a function, which is the C library's. */
#define REAL(type, name, ...)              \
  static type (*real)(__VA_ARGS__) = NULL; \
  if (real == NULL) real = (type(*)(__VA_ARGS__))dlsym(RTLD_NEXT, name)

static void read_settings(void) {
  const char* const kinds = getenv("FAILING_KINDS");
  for (int kind = 0; kinds != NULL && kind < kKinds; ++kind) {
    const size_t length = strlen(kKindNames[kind]);
    for (const char* at = kinds; (at = strstr(at, kKindNames[kind])) != NULL; at += length) {
      const int begins = at == kinds || at[-1] == ',';
      if (begins && (at[length] == '\0' || at[length] == ',')) chosen_kinds |= 1U << (unsigned)kind;
    }
  }
  const char* const at = getenv("FAILING_AT");
  if (at != NULL) chosen_number = strtoull(at, NULL, 10);
  const char* const on = getenv("FAILING_ON");
  goes_on = on != NULL && strcmp(on, "1") == 0;
  const char* const how = getenv("FAILING_HOW");
  for (size_t k = 0; how != NULL && k < sizeof kErrors / sizeof *kErrors; ++k) {
    if (strcmp(how, kErrors[k].name) == 0) error_number = kErrors[k].number;
  }
  is_short = how != NULL && strcmp(how, "short") == 0;
  is_kill_after = how != NULL && strcmp(how, "kill-after") == 0;
  folders = getenv("FAILING_BELOW");
}

static void share_state(void) {
  const char* const name = getenv("FAILING_STATE");
  if (name == NULL) return;
  REAL(int, "open", const char*, int, ...);
  const int descriptor = real(name, O_RDWR | O_CLOEXEC);
  if (descriptor < 0) abort();
  void* const shared = mmap(NULL, sizeof(struct CallState), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (shared == MAP_FAILED) abort();
  state = shared;
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

static int counted_main(int count, char** arguments, char** variables) {
  is_main = 1;
  const int code = real_main(count, arguments, variables);
  is_main = 0;
  return code;
}

// NOLINTNEXTLINE(clang-diagnostic-reserved-identifier, readability-identifier-naming): the C library's name
int __libc_start_main(int (*main)(int, char**, char**), int count, char** arguments, void (*begin)(void),
                      void (*end)(void), void (*end_of_loader)(void), void* stack) {
  REAL(int, "__libc_start_main", int (*)(int, char**, char**), int, char**, void (*)(void), void (*)(void),
       void (*)(void), void*);
  real_main = main;
  if (!is_of_program()) return real(main, count, arguments, begin, end, end_of_loader, stack);
  read_settings();
  share_state();
  return real(counted_main, count, arguments, begin, end, end_of_loader, stack);
}

enum Fate fate_of(enum CallKind kind, int changes, const char* call, const char* path) {
  const int saved = errno;
  atomic_fetch_add(&state->counts[kind], 1);
  if (changes) atomic_fetch_add(&state->counts[kChange], 1);
  const unsigned kinds = 1U << (unsigned)kind | (changes ? 1U << (unsigned)kChange : 0U);
  if ((chosen_kinds & kinds) == 0) return kGoesOn;
  const uint64_t number = atomic_fetch_add(&state->chosen, 1) + 1;
  if (chosen_number == 0 || number < chosen_number || (number > chosen_number && !goes_on)) return kGoesOn;
  if (atomic_fetch_add(&state->befallen, 1) == 0) snprintf(state->where, sizeof state->where, "%s %s", call, path);
  errno = saved;
  if (is_short) return kIsShort;
  if (is_kill_after) return kDiesAfter;
  if (error_number == 0) raise(SIGKILL);
  errno = error_number;
  return kFails;
}

static int is_below(const char* path) {
  if (folders == NULL) return 1;
  for (const char* begin = folders; begin != NULL && *begin != '\0';) {
    const char* const colon = strchr(begin, ':');
    const size_t length = colon != NULL ? (size_t)(colon - begin) : strlen(begin);
    if (strncmp(path, begin, length) == 0 && (path[length] == '/' || path[length] == '\0')) return 1;
    begin = colon != NULL ? colon + 1 : NULL;
  }
  return 0;
}

/* The file of a descriptor, where it counts. */
static int counts_descriptor(int descriptor, char path[PATH_MAX]) {
  if (!is_main) return 0;
  const int saved = errno;
  char name[64];
  snprintf(name, sizeof name, "/proc/self/fd/%d", descriptor);
  struct stat status;
  const ssize_t length = readlink(name, path, PATH_MAX - 1);
  const int counts =
      length > 0 && fstat(descriptor, &status) == 0 && (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode));
  if (counts) path[length] = '\0';
  errno = saved;
  return counts && is_below(path);
}

/* "work/../outside" is not below work. */
static void resolve_folder(char path[PATH_MAX]) {
  char folder[PATH_MAX];
  char whole[PATH_MAX + NAME_MAX + 2];
  char* const slash = strrchr(path, '/');
  if (slash == NULL || strstr(path, "/..") == NULL) return;
  *slash = '\0';
  folder[0] = '\0';
  const int is_resolved = realpath(path, folder) != NULL;
  *slash = '/';
  snprintf(whole, sizeof whole, "%s/%.255s", folder, slash + 1);
  if (is_resolved && strlen(whole) < PATH_MAX) strcpy(path, whole);
}

/* The file of a name in a folder, where it counts. */
static int counts_path(int folder, const char* name, char path[PATH_MAX]) {
  if (!is_main || name == NULL) return 0;
  const int saved = errno;
  path[0] = '\0';
  if (name[0] != '/' && folder == AT_FDCWD && getcwd(path, PATH_MAX) == NULL) path[0] = '\0';
  if (name[0] != '/' && folder != AT_FDCWD) {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", folder);
    const ssize_t length = readlink(link, path, PATH_MAX - 1);
    path[length > 0 ? length : 0] = '\0';
  }
  const size_t length = strlen(path);
  snprintf(path + length, PATH_MAX - length, "%s%s", length > 0 ? "/" : "", name);
  resolve_folder(path);
  errno = saved;
  struct stat status;
  const int is_odd = stat(path, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
  errno = saved;
  return !is_odd && is_below(path);
}

static void die_if(enum Fate fate) {
  if (fate == kDiesAfter) raise(SIGKILL);
}

/* A call of a descriptor or of a name: FAILED is what it returns when it fails. */
#define CALL(counts, kind, changes, call, failed, result_type, real_call)         \
  char path[PATH_MAX];                                                            \
  const enum Fate fate = (counts) ? fate_of(kind, changes, call, path) : kGoesOn; \
  if (fate == kFails) return failed;                                              \
  result_type result = real_call;                                                 \
  die_if(fate);                                                                   \
  return result

static int makes_or_cuts(int flags) { return (flags & (O_CREAT | O_TRUNC)) != 0; }

#define OPEN(name)                                                                                                 \
  int name(const char* file, int flags, ...) {                                                                     \
    REAL(int, #name, const char*, int, ...);                                                                       \
    va_list rest;                                                                                                  \
    va_start(rest, flags);                                                                                         \
    const mode_t mode = (flags & (O_CREAT | __O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;                         \
    va_end(rest);                                                                                                  \
    CALL(counts_path(AT_FDCWD, file, path), kOpen, makes_or_cuts(flags), #name, -1, int, real(file, flags, mode)); \
  }
OPEN(open)
OPEN(open64)

#define OPENAT(name)                                                                       \
  int name(int folder, const char* file, int flags, ...) {                                 \
    REAL(int, #name, int, const char*, int, ...);                                          \
    va_list rest;                                                                          \
    va_start(rest, flags);                                                                 \
    const mode_t mode = (flags & (O_CREAT | __O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0; \
    va_end(rest);                                                                          \
    CALL(counts_path(folder, file, path), kOpen, makes_or_cuts(flags), #name, -1, int,     \
         real(folder, file, flags, mode));                                                 \
  }
OPENAT(openat)
OPENAT(openat64)

int creat(const char* file, mode_t mode) { return open(file, O_CREAT | O_WRONLY | O_TRUNC, mode); }
int creat64(const char* file, mode_t mode) { return open64(file, O_CREAT | O_WRONLY | O_TRUNC, mode); }

#define FOPEN(name)                                                                                       \
  FILE* name(const char* file, const char* mode) {                                                        \
    REAL(FILE*, #name, const char*, const char*);                                                         \
    CALL(counts_path(AT_FDCWD, file, path), kOpen, mode[0] != 'r', #name, NULL, FILE*, real(file, mode)); \
  }
FOPEN(fopen)
FOPEN(fopen64)

DIR* opendir(const char* name) {
  REAL(DIR*, "opendir", const char*);
  CALL(counts_path(AT_FDCWD, name, path), kOpen, 0, "opendir", NULL, DIR*, real(name));
}

static size_t shortened(enum Fate fate, size_t size) { return fate == kIsShort && size > 1 ? size / 2 : size; }

/* A transfer of `size` bytes; the real call names `moved`, which is fewer of them where it is short. */
#define MOVE(kind, changes, call, descriptor, size, real_call)                                               \
  char path[PATH_MAX];                                                                                       \
  const enum Fate fate = counts_descriptor(descriptor, path) ? fate_of(kind, changes, call, path) : kGoesOn; \
  if (fate == kFails) return -1;                                                                             \
  const size_t moved = shortened(fate, size);                                                                \
  const ssize_t result = real_call;                                                                          \
  die_if(fate);                                                                                              \
  return result

ssize_t read(int descriptor, void* data, size_t size) {
  REAL(ssize_t, "read", int, void*, size_t);
  MOVE(kRead, 0, "read", descriptor, size, real(descriptor, data, moved));
}

ssize_t write(int descriptor, const void* data, size_t size) {
  REAL(ssize_t, "write", int, const void*, size_t);
  MOVE(kWrite, 1, "write", descriptor, size, real(descriptor, data, moved));
}

#define PREAD(name)                                                                 \
  ssize_t name(int descriptor, void* data, size_t size, off_t offset) {             \
    REAL(ssize_t, #name, int, void*, size_t, off_t);                                \
    MOVE(kRead, 0, #name, descriptor, size, real(descriptor, data, moved, offset)); \
  }
PREAD(pread)
PREAD(pread64)

#define PWRITE(name)                                                                 \
  ssize_t name(int descriptor, const void* data, size_t size, off_t offset) {        \
    REAL(ssize_t, #name, int, const void*, size_t, off_t);                           \
    MOVE(kWrite, 1, #name, descriptor, size, real(descriptor, data, moved, offset)); \
  }
PWRITE(pwrite)
PWRITE(pwrite64)

#define SENDFILE(name)                                               \
  ssize_t name(int to, int from, off_t* offset, size_t size) {       \
    REAL(ssize_t, #name, int, int, off_t*, size_t);                  \
    MOVE(kWrite, 1, #name, to, size, real(to, from, offset, moved)); \
  }
SENDFILE(sendfile)
SENDFILE(sendfile64)

/* Of several parts, the first alone is a short transfer. */
#define VECTORS(name, kind, changes)                                                            \
  ssize_t name(int descriptor, const struct iovec* parts, int count) {                          \
    REAL(ssize_t, #name, int, const struct iovec*, int);                                        \
    MOVE(kind, changes, #name, descriptor, (size_t)count, real(descriptor, parts, (int)moved)); \
  }
VECTORS(readv, kRead, 0)
VECTORS(writev, kWrite, 1)

int fsync(int descriptor) {
  REAL(int, "fsync", int);
  CALL(counts_descriptor(descriptor, path), kSync, 0, "fsync", -1, int, real(descriptor));
}

int fdatasync(int descriptor) {
  REAL(int, "fdatasync", int);
  CALL(counts_descriptor(descriptor, path), kSync, 0, "fdatasync", -1, int, real(descriptor));
}

/* One that fails has closed the file nevertheless, as on Linux. */
int close(int descriptor) {
  REAL(int, "close", int);
  CALL(counts_descriptor(descriptor, path), kClose, 0, "close", (real(descriptor), errno = error_number, -1), int,
       real(descriptor));
}

int fclose(FILE* file) {
  REAL(int, "fclose", FILE*);
  CALL(counts_descriptor(fileno(file), path), kClose, 0, "fclose", (real(file), errno = error_number, EOF), int,
       real(file));
}

int rename(const char* from, const char* to) {
  REAL(int, "rename", const char*, const char*);
  CALL(counts_path(AT_FDCWD, to, path), kRename, 1, "rename", -1, int, real(from, to));
}

int renameat(int old_folder, const char* from, int folder, const char* to) {
  REAL(int, "renameat", int, const char*, int, const char*);
  CALL(counts_path(folder, to, path), kRename, 1, "renameat", -1, int, real(old_folder, from, folder, to));
}

int renameat2(int old_folder, const char* from, int folder, const char* to, unsigned flags) {
  REAL(int, "renameat2", int, const char*, int, const char*, unsigned);
  CALL(counts_path(folder, to, path), kRename, 1, "renameat2", -1, int, real(old_folder, from, folder, to, flags));
}

#define ONE_NAME(name, kind)                                                      \
  int name(const char* file) {                                                    \
    REAL(int, #name, const char*);                                                \
    CALL(counts_path(AT_FDCWD, file, path), kind, 1, #name, -1, int, real(file)); \
  }
ONE_NAME(unlink, kUnlink)
ONE_NAME(rmdir, kUnlink)
ONE_NAME(remove, kUnlink)

int unlinkat(int folder, const char* file, int flags) {
  REAL(int, "unlinkat", int, const char*, int);
  CALL(counts_path(folder, file, path), kUnlink, 1, "unlinkat", -1, int, real(folder, file, flags));
}

int mkdir(const char* file, mode_t mode) {
  REAL(int, "mkdir", const char*, mode_t);
  CALL(counts_path(AT_FDCWD, file, path), kMkdir, 1, "mkdir", -1, int, real(file, mode));
}

int link(const char* from, const char* to) {
  REAL(int, "link", const char*, const char*);
  CALL(counts_path(AT_FDCWD, to, path), kLink, 1, "link", -1, int, real(from, to));
}

int linkat(int old_folder, const char* from, int folder, const char* to, int flags) {
  REAL(int, "linkat", int, const char*, int, const char*, int);
  CALL(counts_path(folder, to, path), kLink, 1, "linkat", -1, int, real(old_folder, from, folder, to, flags));
}

int symlink(const char* text, const char* to) {
  REAL(int, "symlink", const char*, const char*);
  CALL(counts_path(AT_FDCWD, to, path), kLink, 1, "symlink", -1, int, real(text, to));
}

#define TRUNCATE(name)                                                                               \
  int name(int descriptor, off_t size) {                                                             \
    REAL(int, #name, int, off_t);                                                                    \
    CALL(counts_descriptor(descriptor, path), kTruncate, 1, #name, -1, int, real(descriptor, size)); \
  }
TRUNCATE(ftruncate)
TRUNCATE(ftruncate64)

int truncate(const char* file, off_t size) {
  REAL(int, "truncate", const char*, off_t);
  CALL(counts_path(AT_FDCWD, file, path), kTruncate, 1, "truncate", -1, int, real(file, size));
}

#define MAP(name)                                                                                   \
  void* name(void* address, size_t size, int protection, int flags, int descriptor, off_t offset) { \
    REAL(void*, #name, void*, size_t, int, int, int, off_t);                                        \
    CALL(counts_descriptor(descriptor, path), kMap, 0, #name, MAP_FAILED, void*,                    \
         real(address, size, protection, flags, descriptor, offset));                               \
  }
MAP(mmap)
MAP(mmap64)
