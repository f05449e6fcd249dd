/* Where two shapes touch: their nearest points, in closed forms. */
#pragma once

#include "read/context/attributes.h"

/* A place where they may touch, in nodes along the base's axes. */
struct Touch {
  struct Vector point;  /* m */
  struct Vector normal; /* of length 1, towards the first shape */
  Node gap;             /* m, 0 where they touch */
};

struct Touches {
  struct Touch *items;
  size_t count;
};

/* Where a shape is, and how it moves, while nothing is displaced. */
struct Side {
  const struct ContactShape *shape;
  struct Pose pose; /* of what it is part of */
};

struct Side side_of_contact(struct Reader *reader, long line, const struct ContactShape *shape);

/* How many touches two shapes have, also before they are placed, but after a mesh's corners are found; 0 where there is no closed form. */
size_t count_touches(const struct ContactShape *first, const struct ContactShape *second);

/* As many of them. */
struct Touches touches_of(struct Reader *reader, long line, const struct Side *first, const struct Side *second);
