/* Where the things of a system are at its start values, on the paper, and which of them are linked. */
#ifndef DRAWN_POINTS_H
#define DRAWN_POINTS_H

#include "model/model.h"

enum PointKind { ORIGIN, FRAME_POINT, PARTICLE_POINT, BODY_POINT, MERE_POINT };

/* In the units of the system, to the right and upwards. */
struct DrawnPoint {
  enum PointKind kind;
  double right, up;
  double half_right, half_up; /* of a body: from its middle to the end of the uniform bar that it would be */
};

/* Two points by their places. */
struct DrawnLink {
  size_t from, to;
};

struct Drawing {
  struct DrawnPoint *points;
  size_t count;
  struct DrawnLink *links;
  size_t link_count;
};

/* The first point is the origin; there are no others where nothing can be drawn. */
struct Drawing drawing_of(const struct Model *model);

#endif
