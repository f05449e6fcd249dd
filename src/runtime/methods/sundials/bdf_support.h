/* Backward differentiation formulas, for dense and sparse Jacobian matrices. */
#pragma once

#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

#include "methods/sundials/sundials_support.h"

/* The struct Solver for one kind of matrix. */
#define BDF_SOLVER(title, creator)                                                                                     \
  {                                                                                                                    \
    .name = (title), .alternatives = "auto where inputs change often", .finer = "<solver method=\"taylor\"/>",         \
    .run = sundials_run, .create = (creator), .destroy = sundials_destroy, .restart = bdf_restart,                     \
    .advance = bdf_advance, .interpolate = bdf_interpolate                                                             \
  }

/* Memory of the method, for either kind of matrix. */
struct Bdf {
  struct Sundials sundials;
  void *cvode;
  SUNMatrix matrix;
  SUNLinearSolver linear_solver;
  double *jacobian; /* elements in lagrangian.implicit.pattern */
  /* Writes jacobian into the matrix, whose elements are 0. */
  void (*fill)(const struct Bdf *bdf, SUNMatrix matrix);
};

/* Configures CVODE with matrix, linear_solver and fill, which the caller has set. False if that fails. */
bool bdf_configure(struct Instance *instance);

/* Implement the functions of these names in struct Solver, for both kinds of matrix. */
bool bdf_restart(struct Instance *instance, const double *state, const struct CommunicationStep *step);
const char *bdf_advance(struct Instance *instance, const struct CommunicationStep *step);
bool bdf_interpolate(struct Instance *instance, double time, double *state);
