/* Backward differentiation formulas, for any form of the Jacobian matrix. */
#ifndef BDF_SUPPORT_H
#define BDF_SUPPORT_H

#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

#include "methods/sundials/sundials_support.h"

/* Where others are right instead, see struct Solver. */
#define BDF_ALTERNATIVES "auto where inputs change often"

struct Bdf {
  struct Sundials sundials;
  void *cvode;
  SUNMatrix matrix;
  SUNLinearSolver linear_solver;
  double *jacobian; /* the elements in lagrangian.jacobian_pattern */
  /* Writes them into the matrix, whose elements are 0. */
  void (*fill)(const struct Bdf *bdf, SUNMatrix matrix);
};

/* Configures CVODE with matrix, linear_solver and fill, which the caller has set; false where that fails. */
bool bdf_configure(struct Instance *instance);

/* What the descriptors share. */
bool bdf_restart(struct Instance *instance, const double *state, const struct CommunicationStep *step);
const char *bdf_advance(struct Instance *instance, const struct CommunicationStep *step);
bool bdf_interpolate(struct Instance *instance, double time, double *state);

#endif
