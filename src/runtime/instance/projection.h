/* Brings states back to the constraints. FMUs without constraints do not hold it. */
#ifndef PROJECTION_H
#define PROJECTION_H

#include "instance/instance.h"

struct Projection {
  /*
   * Moves a state that is near the constraints onto them, the least in the metric of M: first the coordinates, then the
   * velocities. Returns the largest change in units of the variables' scales; INFINITY where they cannot be fulfilled,
   * and the state is then undefined.
   */
  double (*project)(struct Instance *instance, double time, double *state);
  /* How far project() would move the state of the instance at its time, which stays as it is. */
  double (*drift)(struct Instance *instance, double time);
  /*
   * The same with the start values of the instance, however far they are; fixed coordinates and their velocities stay. Logs
   * what was moved. False after logging why the constraints cannot be fulfilled.
   */
  bool (*make_consistent)(struct Instance *instance);
  /*
   * The same with the state at the beginning of a step, after parameters or inputs were set. False after logging as what
   * discards the step why the constraints cannot be fulfilled; the state is then as it was.
   */
  bool (*follow_change)(struct Instance *instance);
  /* The constraint that lacks most of those that the last project() or drift() at this time could not keep, or not by a small move. */
  size_t (*unkept)(struct Instance *instance, double time);
  /* The name of the constraint that has least hold on a state, as at the limit of a mechanism; NULL where unknown. */
  const char *(*weakest)(struct Instance *instance, double time, const double *state);
};

extern const struct Projection projection;

/* Numbers of workspace that an instance needs for it. */
static inline size_t projection_work_count(void) {
  if (lagrangian.constraints.projection == NULL) return 0;
  return lagrangian.coordinate_count + 4 * lagrangian.constraints.count + 3 * lagrangian.state_count +
         indicator_count(lagrangian.switches);
}

#endif
