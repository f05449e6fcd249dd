/* The points of a system: its origin, frames, particles, bodies and mere points; and which of them rods hold together. */
#ifndef THINGS_H
#define THINGS_H

#include "configurations.h"

enum ThingKind { ORIGIN, FRAME_POINT, PARTICLE_POINT, BODY_POINT, SOLID_POINT, MERE_POINT };

struct Thing {
  enum ThingKind kind;
  const char *name;        /* NULL for the origin */
  const struct Body *body; /* NULL for the origin and frames */
  Node position[3];
  bool is_framed; /* the origin, a frame, or what is in one */
  size_t frame;   /* of a framed thing: itself, or the one that it is in */
};

struct Things {
  struct Thing *items; /* the first is the origin */
  size_t count;
  bool are_in_space;
};

struct Things things_of(const struct Model *model);

/* Two things by their places. */
struct Link {
  size_t from, to;
};

struct Links {
  struct Link *items;
  size_t count;
};

/*
 * Of frames each to what is in it, as long as no constraint closes a loop. Else things whose distance is the same wherever the constraints let the coordinates be, and of which one moves. values: of all nodes at
 * the start.
 */
struct Links links_of(const struct Model *model, const struct Equations *equations, const struct Things *things,
                      const double *values);

#endif
