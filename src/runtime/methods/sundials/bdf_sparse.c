/* BDF with a Jacobian matrix in compressed columns, factored by KLU, for large systems. */
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include "methods/sundials/bdf_support.h"

/* Memory of the method; bdf is its first member. */
struct SparseBdf {
  struct Bdf bdf;
  /* The pattern of I - gamma J: that of J, and the diagonal. slot[k] is the index of J's element k in it. */
  sunindextype *start, *row, *slot;
};

/* Merges the diagonal into the pattern of the Jacobian. */
static void add_diagonal(struct SparseBdf *sparse) {
  const struct Sparsity *pattern = &lagrangian.implicit.pattern;
  sunindextype count = 0;
  for (size_t j = 0; j < lagrangian.state_count; j++) {
    int k = pattern->start[j], end = pattern->start[j + 1], diagonal = (int)j;
    sparse->start[j] = count;
    for (; k < end && pattern->row[k] < diagonal; k++) {
      sparse->slot[k] = count;
      sparse->row[count++] = pattern->row[k];
    }
    sparse->row[count++] = diagonal;
    if (k < end && pattern->row[k] == diagonal) sparse->slot[k++] = count - 1;
    for (; k < end; k++) {
      sparse->slot[k] = count;
      sparse->row[count++] = pattern->row[k];
    }
  }
  sparse->start[lagrangian.state_count] = count;
}

static void fill(const struct Bdf *bdf, SUNMatrix matrix) {
  const struct SparseBdf *sparse = (const struct SparseBdf *)bdf;
  size_t states = lagrangian.state_count, count = (size_t)sparse->start[states];
  for (size_t j = 0; j <= states; j++) SUNSparseMatrix_IndexPointers(matrix)[j] = sparse->start[j];
  for (size_t k = 0; k < count; k++) SUNSparseMatrix_IndexValues(matrix)[k] = sparse->row[k];
  for (size_t k = 0; k < lagrangian.implicit.pattern.count; k++)
    SUNSparseMatrix_Data(matrix)[sparse->slot[k]] = bdf->jacobian[k];
}

static bool configure(struct Instance *instance) {
  struct SparseBdf *sparse = instance->solver_memory;
  struct Bdf *bdf = &sparse->bdf;
  SUNContext context = bdf->sundials.context;
  size_t states = lagrangian.state_count, elements = lagrangian.implicit.pattern.count;
  sparse->start = sundials_allocate(states + 1 + (elements + states) + elements, sizeof *sparse->start);
  sparse->row = sparse->start + states + 1;
  sparse->slot = sparse->row + elements + states;
  add_diagonal(sparse);
  sunindextype n = (sunindextype)states;
  bdf->fill = fill;
  bdf->matrix = SUNSparseMatrix(n, n, sparse->start[states], CSC_MAT, context);
  bdf->linear_solver = SUNLinSol_KLU(bdf->sundials.state, bdf->matrix, context);
  return bdf_configure(instance);
}

static bool create(struct Instance *instance) {
  return sundials_create(instance, sizeof(struct SparseBdf), configure);
}

const struct Solver solver_bdf_sparse = BDF_SOLVER("CVODE with KLU", create);
