/* Projection of states onto the constraints (methods/projection.c). FMUs without constraints do not link it. */
#pragma once

#include "instance/instance.h"

/* The functions of the projection. */
struct Projection {
  /* Prepares a block as workspace. Returns its size; without a block only counts. */
  size_t (*lay_out)(void *block);
  /*
   * Projects a state near the constraints onto them by the least move in the metric of M: first the coordinates, then
   * the velocities. Returns the largest change in units of the scales. Returns INFINITY if that fails; the state is
   * then undefined.
   */
  double (*project)(struct Instance *instance, double time, double *state);
  /* Returns the change by project() at the instance's state, which stays as it is. */
  double (*drift)(struct Instance *instance, double time);
  /*
   * Returns the instance's state after project(), valid until the next projection. It is NULL if that fails, or if
   * the state fulfils the constraints up to 1e-9 of the scales.
   */
  const double *(*nearest)(struct Instance *instance, double time);
  /* True if the last project() or drift() has found redundant constraints. */
  bool (*found_redundant)(struct Instance *instance);
  /*
   * Projects the start values, from any distance; fixed coordinates and their velocities stay. Logs the moves. False
   * after logging an error.
   */
  bool (*make_consistent)(struct Instance *instance);
  /*
   * Projects the state at the start of a step, after parameters or inputs were set. False after logging why the step is
   * discarded; the state is then as before.
   */
  bool (*follow_change)(struct Instance *instance);
  /*
   * Returns the constraint of largest residual after the last project() or drift(), at the same time, has failed or
   * moved too far.
   */
  size_t (*violated_constraint)(struct Instance *instance, double time);
  /*
   * Returns the name of the constraint whose row of the Jacobian is closest to singular, as at the limit of a
   * mechanism; NULL if unknown.
   */
  const char *(*weakest)(struct Instance *instance, double time, const double *state);
};

extern const struct Projection projection;
