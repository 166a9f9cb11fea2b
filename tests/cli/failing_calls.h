/* What the preloaded library of failing calls shares with the tests: which calls count, and what befalls the chosen
 * one. */
#pragma once

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

/* In the order of kKindNames; the driver reads the counts in this order. */
enum CallKind {
  kOpen,
  kRead,
  kWrite,
  kSync,
  kClose,
  kRename,
  kUnlink,
  kMkdir,
  kLink,
  kTruncate,
  kMap,
  kChange, /* whichever of them changes something in a folder or a file */
  kKinds
};

/* What befalls a call: nothing, errno and no call, fewer bytes, or a kill. */
enum Fate { kGoesOn, kFails, kIsShort, kDiesAfter };

/* Shared by a process and those that it starts, so that "the k-th" is one call of them all, and what was counted is
 * there when they were killed. */
struct CallState {
  _Atomic uint64_t counts[kKinds];
  _Atomic uint64_t chosen;   /* calls of the chosen kinds */
  _Atomic uint64_t befallen; /* how many of them were made to fail */
  char where[1024];          /* the first of them, its name and its file */
};

/* The fate of a call of the kind, which is counted. `changes` says whether it changes something in a folder. */
enum Fate fate_of(enum CallKind kind, int changes, const char* call, const char* path);
