/* What holds things together: rods and joints, whether a formula or a constraint keeps them. */
#pragma once

#include "samples.h"

enum { FORCES = 2, PLACES = 4 };

/* Two things whose distance stays the same; one constraint's force, times the factor, presses them apart. */
struct Rod {
  size_t from, to; /* among the things; from may be the base */
  double length;
  size_t constraint; /* among the model's, where has_force */
  bool has_force;
  double factor;
};

/* A place of a body in the plane that it shares with another thing; forces of constraints push the body there. */
struct Joint {
  size_t of, with;
  double place
      [PLACES]; /* m: x and y along the body's axes, and x and y along those of the other, if it is a body in the plane too, or from its place */
  size_t force_count;
  size_t constraints[FORCES]; /* among the model's */
  double along[FORCES][2];    /* N along x and y for each unit of the constraint's force */
};

struct Links {
  struct Rod *rods;
  size_t rod_count;
  struct Joint *joints;
  size_t joint_count;
};

/* Finds the place that a body in the plane and another thing share, and what forces push there; false where there is none. */
bool find_joint(const struct Samples *samples, struct Joint *joint);

struct Links find_links(const struct Samples *samples);
