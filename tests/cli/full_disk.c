/* Preloaded to make the disk full: of the writes and syncs of regular files, the one that the environment variable
 * FULL_DISK_AT names (from 1) and all later ones fail with ENOSPC. Where the number is 0 they are only counted: at the
 * end the count goes into the file FULL_DISK_COUNT. KILLED_AT_RENAME names the rename (from 1) before which the process
 * is killed. */
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

static long writes = 0;

static int disk_is_full(int descriptor) {
  const char* const at = getenv("FULL_DISK_AT");
  struct stat status;
  if (at == NULL || fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return 0;
  ++writes;
  if (atol(at) == 0 || writes < atol(at)) return 0;
  errno = ENOSPC;
  return 1;
}

ssize_t write(int descriptor, const void* data, size_t size) {
  static ssize_t (*real)(int, const void*, size_t) = NULL;
  if (real == NULL) real = (ssize_t(*)(int, const void*, size_t))dlsym(RTLD_NEXT, "write");
  return disk_is_full(descriptor) ? -1 : real(descriptor, data, size);
}

ssize_t writev(int descriptor, const struct iovec* parts, int count) {
  static ssize_t (*real)(int, const struct iovec*, int) = NULL;
  if (real == NULL) real = (ssize_t(*)(int, const struct iovec*, int))dlsym(RTLD_NEXT, "writev");
  return disk_is_full(descriptor) ? -1 : real(descriptor, parts, count);
}

int fsync(int descriptor) {
  static int (*real)(int) = NULL;
  if (real == NULL) real = (int (*)(int))dlsym(RTLD_NEXT, "fsync");
  return disk_is_full(descriptor) ? -1 : real(descriptor);
}

int fdatasync(int descriptor) {
  static int (*real)(int) = NULL;
  if (real == NULL) real = (int (*)(int))dlsym(RTLD_NEXT, "fdatasync");
  return disk_is_full(descriptor) ? -1 : real(descriptor);
}

int rename(const char* from, const char* to) {
  static int (*real)(const char*, const char*) = NULL;
  static long renames = 0;
  if (real == NULL) real = (int (*)(const char*, const char*))dlsym(RTLD_NEXT, "rename");
  const char* const at = getenv("KILLED_AT_RENAME");
  if (at != NULL && ++renames == atol(at)) raise(SIGKILL);
  return real(from, to);
}

__attribute__((destructor)) static void report(void) {
  const char* const name = getenv("FULL_DISK_COUNT");
  if (name == NULL) return;
  FILE* const file = fopen(name, "w");
  if (file == NULL) return;
  fprintf(file, "%ld\n", writes);
  fclose(file);
}
