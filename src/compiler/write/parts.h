/*
 * A long routine in parts, each of which becomes a function: what a compiler takes for a function grows faster than its length.
 */
#pragma once

#include "program/values/routine.h"

/* What several parts know, in a routine that was divided: elements of an array. */
enum { SPACE_SHARED = SPACE_COUNT };

struct Parts {
  struct Routine **items;
  size_t count;
  size_t steady_count; /* of the first, which another direction at the same point leaves as they are */
  size_t shared_count;
};

/*
 * One part for a routine that is short, or that works on blocks, which stays as it is. accelerations: how many of them the routine
 * has for itself, which its parts share; 0 where they are in what it fills.
 */
struct Parts parts_of(struct Routine *routine, size_t accelerations);
