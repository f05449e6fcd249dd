/* Velocities that are exactly 0 at rest (src/runtime/rests/resting_velocities.c). */
#ifndef RESTING_H
#define RESTING_H

enum RestingKind {
  RESTING_VELOCITY, /* of a coordinate */
  RESTING_DRIVE,    /* of a coordinate with a prescribed motion */
  RESTING_SUM       /* of velocities, in the indicator of a branch */
};

/* Modes of such a velocity. The acceleration of a drive that moves is 0 here and nearby. */
enum RestingMode { VELOCITY_RESTS, VELOCITY_MOVES, VELOCITY_ACCELERATES };

#endif
