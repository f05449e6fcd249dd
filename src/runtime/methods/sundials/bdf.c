/* BDF with a dense Jacobian matrix, for small systems. */
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include "methods/sundials/bdf_support.h"

static void fill(const struct Bdf *bdf, SUNMatrix matrix) {
  const struct Sparsity *pattern = &lagrangian.implicit.pattern;
  for (size_t j = 0; j < lagrangian.state_count; j++) {
    double *column = SUNDenseMatrix_Column(matrix, (sunindextype)j);
    for (int k = pattern->start[j]; k < pattern->start[j + 1]; k++) column[pattern->row[k]] = bdf->jacobian[k];
  }
}

static bool configure(struct Instance *instance) {
  struct Bdf *bdf = instance->solver_memory;
  sunindextype n = (sunindextype)lagrangian.state_count;
  bdf->fill = fill;
  bdf->matrix = SUNDenseMatrix(n, n, bdf->sundials.context);
  bdf->linear_solver = SUNLinSol_Dense(bdf->sundials.state, bdf->matrix, bdf->sundials.context);
  return bdf_configure(instance);
}

static bool create(struct Instance *instance) {
  return sundials_create(instance, sizeof(struct Bdf), configure);
}

const struct Solver solver_bdf = BDF_SOLVER("CVODE", create);
