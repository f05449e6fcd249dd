/* What contacts push against, where it can be seen: floors, walls and stops. */
#ifndef SURFACES_H
#define SURFACES_H

#include "things.h"

/* A plane through a place; the normal, of length 1, points to the side on which the system is. */
struct Surface {
  double place[3], normal[3];
  bool is_stop; /* met by turning a coordinate, so that only a piece of it is there */
};

struct Surfaces {
  struct Surface *items;
  size_t count;
};

struct Surfaces surfaces_of(const struct Model *model, const struct Equations *equations, const struct Things *things);

#endif
