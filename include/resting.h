/* Velocities that are exactly 0 at rest (src/runtime/nonsmooth/rests/resting_velocities.c). */
#ifndef RESTING_H
#define RESTING_H

enum RestingKind {
  RESTING_VELOCITY,   /* of a coordinate */
  RESTING_PRESCRIBED, /* of a coordinate with a prescribed motion */
  RESTING_SUM         /* of velocities, in the indicator of a branch */
};

/* Modes of such a velocity. A prescribed velocity that moves has no acceleration here and nearby. */
enum RestingMode { VELOCITY_RESTS, VELOCITY_MOVES, VELOCITY_ACCELERATES };

#endif
