/* Modes and sliding speeds of frictions, along a line or in a plane. */
#pragma once

#include <math.h>

#include "evaluation/evaluate.h"
#include "instance/active_constraints.h"
#include "nonsmooth/resolution.h"

/* True if the friction sticks in the present modes. */
static inline bool friction_sticks(const struct Resolution *resolution, size_t friction) {
  return friction_holds(resolution->instance, friction);
}

/* Returns the force of a friction along a line that sticks. */
static inline double force_on_line(const struct Resolution *resolution, size_t friction) {
  size_t constraint = resolution->switches->frictions[friction].constraint,
         sliding = friction_slot(resolution->switches, friction, FRICTION_FORCE);
  return resolution->acceleration[lagrangian.coordinate_count + constraint] +
         carried_share(resolution->instance, friction) * resolution->value[sliding];
}

/* Returns the mode of a friction in a plane. */
static inline enum PlaneMode plane_mode(const struct Resolution *resolution, const struct PlaneMetadata *plane) {
  return (enum PlaneMode)mode_of(resolution, resolution->switches->frictions[plane->along].mode);
}

/* Returns the speed of a friction in a plane. along: index of the first of its two frictions. */
static inline double speed_in_plane(const struct Resolution *resolution, size_t along) {
  const double *value = resolution->value;
  return hypot(value[friction_slot(resolution->switches, along, FRICTION_VELOCITY)],
               value[friction_slot(resolution->switches, along + 1, FRICTION_VELOCITY)]);
}

/* Returns the sliding speed of a friction. */
static inline double sliding_speed(const struct Resolution *resolution, size_t friction) {
  size_t plane = plane_of(resolution->switches, friction);
  if (plane < resolution->switches->plane_count)
    return speed_in_plane(resolution, resolution->switches->planes[plane].along);
  return fabs(resolution->value[friction_slot(resolution->switches, friction, FRICTION_VELOCITY)]);
}
