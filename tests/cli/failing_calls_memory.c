/* The allocations of the preloaded library of failing calls. Those count that the program and its modules ask for,
 * directly or by way of the standard library of C++, or by libraries that read and write files for them; those of
 * drivers, of fonts, of cairo, of VTK, of the loader and of the C library itself do not: what they make of a null is
 * theirs. Nor do those of libraries that are being loaded. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <unwind.h>

#include "failing_calls.h"

// The names of the C library and of the language.
// NOLINTBEGIN(clang-diagnostic-reserved-identifier, readability-identifier-naming)
extern void* __libc_malloc(size_t size);
extern void* __libc_calloc(size_t count, size_t size);
extern void* __libc_realloc(void* old, size_t size);
extern void* __libc_memalign(size_t alignment, size_t size);
// NOLINTEND(clang-diagnostic-reserved-identifier, readability-identifier-naming)

enum Owner { kUnknown, kStranger, kOurs, kStandard };

static const char* const kOwn[] = {"/gdtslam", "libpng",    "libz.so",     "libbz2", "liblz4",    "libzstd",
                                   "liblzma",  "libsqlite", "libyaml-cpp", "libfmt", "libcrypto", "libtbb"};
static const char* const kStandardLibraries[] = {"libstdc++", "failing_calls"};

enum { kMostParts = 512 };
static struct {
  uintptr_t begin;
  uintptr_t end;
  enum Owner owner;
} parts[kMostParts];
static _Atomic int part_count = 0;
static pthread_mutex_t parts_lock = PTHREAD_MUTEX_INITIALIZER;
static _Thread_local int is_inside = 0; /* looking for a caller allocates nothing that counts */
static _Thread_local enum Owner owner_of_new = kUnknown;

static enum Owner owner_by_name(const char* name) {
  const char* const base = strrchr(name, '/');
  for (size_t k = 0; k < sizeof kStandardLibraries / sizeof *kStandardLibraries; ++k) {
    if (base != NULL && strstr(base, kStandardLibraries[k]) != NULL) return kStandard;
  }
  if (name[0] == '\0') return kOurs; /* the program itself */
  if (strstr(name, "/gdtslam/") != NULL && strstr(name, ".so") != NULL && strstr(name, "lib/gdtslam/") != NULL)
    return kOurs;
  for (size_t k = 0; k < sizeof kOwn / sizeof *kOwn; ++k) {
    if (base != NULL && strstr(base, kOwn[k]) != NULL) return kOurs;
  }
  return kStranger;
}

static int take_part(struct dl_phdr_info* info, size_t size, void* unused) {
  (void)size;
  (void)unused;
  for (int k = 0; k < info->dlpi_phnum; ++k) {
    if (info->dlpi_phdr[k].p_type != PT_LOAD || (info->dlpi_phdr[k].p_flags & PF_X) == 0) continue;
    const int count = atomic_load(&part_count);
    if (count == kMostParts) return 1;
    parts[count].begin = info->dlpi_addr + info->dlpi_phdr[k].p_vaddr;
    parts[count].end = parts[count].begin + info->dlpi_phdr[k].p_memsz;
    parts[count].owner = owner_by_name(info->dlpi_name);
    atomic_store(&part_count, count + 1);
  }
  return 0;
}

static enum Owner known_owner(uintptr_t address) {
  const int count = atomic_load(&part_count);
  for (int k = 0; k < count; ++k) {
    if (address >= parts[k].begin && address < parts[k].end) return parts[k].owner;
  }
  return kUnknown;
}

/* Modules are loaded while the program runs, so what is not known yet is looked for once more. */
static enum Owner owner_at(uintptr_t address) {
  enum Owner owner = known_owner(address);
  if (owner != kUnknown) return owner;
  pthread_mutex_lock(&parts_lock);
  owner = known_owner(address);
  if (owner == kUnknown) {
    atomic_store(&part_count, 0);
    dl_iterate_phdr(take_part, NULL);
    owner = known_owner(address);
  }
  pthread_mutex_unlock(&parts_lock);
  return owner == kUnknown ? kStranger : owner;
}

static _Unwind_Reason_Code look_at(struct _Unwind_Context* context, void* found) {
  enum Owner* const owner = found;
  *owner = owner_at(_Unwind_GetIP(context));
  return *owner == kStandard ? _URC_NO_REASON : _URC_END_OF_STACK;
}

static enum Owner owner_of_caller(void* address) {
  if (!calls_count() || is_inside) return kStranger;
  is_inside = 1;
  const int saved = errno;
  enum Owner owner = owner_at((uintptr_t)address);
  if (owner == kStandard) {
    owner = kStranger;
    _Unwind_Backtrace(look_at, &owner);
  }
  errno = saved;
  is_inside = 0;
  return owner;
}

/* FAILING_PLACES: a file that gets 8 bytes for each allocation that counts, the same where the same calls of the
 * program led to it, of which the innermost FAILING_CALLERS are looked at. */
struct Place {
  uint64_t hash;
  long callers_left;
};

static _Unwind_Reason_Code add_caller(struct _Unwind_Context* context, void* found) {
  const uint64_t prime = 0x100000001b3; /* of FNV-1a */
  struct Place* const place = found;
  if (owner_at(_Unwind_GetIP(context)) != kOurs) return _URC_NO_REASON;
  place->hash = (place->hash ^ _Unwind_GetIP(context)) * prime;
  return --place->callers_left == 0 ? _URC_END_OF_STACK : _URC_NO_REASON;
}

static void record_place(void) {
  static const char* file = NULL;
  static int descriptor = -1;
  static long callers = 0;
  if (file == NULL) {
    const char* const number = getenv("FAILING_CALLERS");
    callers = number != NULL ? strtol(number, NULL, 10) : 0;
    file = getenv("FAILING_PLACES");
    if (file == NULL) file = "";
    if (file[0] != '\0') descriptor = (int)syscall(SYS_openat, AT_FDCWD, file, O_WRONLY | O_APPEND | O_CLOEXEC);
  }
  if (descriptor < 0) return;
  const int saved = errno;
  struct Place place = {0xcbf29ce484222325, callers};
  is_inside = 1;
  _Unwind_Backtrace(add_caller, &place);
  is_inside = 0;
  if (syscall(SYS_write, descriptor, &place.hash, sizeof place.hash) != sizeof place.hash) abort();
  errno = saved;
}

static int is_refused(void* caller, const char* call) {
  enum Owner owner = owner_of_new;
  owner_of_new = kUnknown;
  if (owner == kUnknown) owner = owner_of_caller(caller);
  if (owner != kOurs) return 0;
  record_place();
  return fate_of(kAllocate, 0, call, "") == kFails;
}

void* malloc(size_t size) { return is_refused(__builtin_return_address(0), "malloc") ? NULL : __libc_malloc(size); }

void* calloc(size_t count, size_t size) {
  return is_refused(__builtin_return_address(0), "calloc") ? NULL : __libc_calloc(count, size);
}

void* realloc(void* old, size_t size) {
  return is_refused(__builtin_return_address(0), "realloc") ? NULL : __libc_realloc(old, size);
}

void* aligned_alloc(size_t alignment, size_t size) {
  return is_refused(__builtin_return_address(0), "aligned_alloc") ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void** result, size_t alignment, size_t size) {
  if (is_refused(__builtin_return_address(0), "posix_memalign")) return ENOMEM;
  void* const memory = __libc_memalign(alignment, size);
  if (memory == NULL) return ENOMEM;
  *result = memory;
  return 0;
}

/* What begins with a library, as VTK's tables do, cannot fail otherwise than by ending the process. */
void* dlopen(const char* file, int mode) {
  static void* (*real)(const char*, int) = NULL;
  if (real == NULL) real = (void* (*)(const char*, int))dlsym(RTLD_NEXT, "dlopen");
  const int was_inside = is_inside;
  is_inside = 1;
  void* const library = real(file, mode);
  is_inside = was_inside;
  return library;
}

/* operator new asks malloc, which sees the standard library as its caller; who called operator new is known here. */
#define NEW(name, declared, passed)                                     \
  void* name declared {                                                 \
    static void*(*real)declared = NULL;                                 \
    if (real == NULL) real = (void*(*)declared)dlsym(RTLD_NEXT, #name); \
    owner_of_new = owner_of_caller(__builtin_return_address(0));        \
    return real passed;                                                 \
  }
// NOLINTBEGIN(clang-diagnostic-reserved-identifier)
NEW(_Znwm, (size_t size), (size))
NEW(_Znam, (size_t size), (size))
NEW(_ZnwmSt11align_val_t, (size_t size, size_t alignment), (size, alignment))
NEW(_ZnamSt11align_val_t, (size_t size, size_t alignment), (size, alignment))
NEW(_ZnwmRKSt9nothrow_t, (size_t size, const void* no_throw), (size, no_throw))
NEW(_ZnamRKSt9nothrow_t, (size_t size, const void* no_throw), (size, no_throw))
// NOLINTEND(clang-diagnostic-reserved-identifier)
