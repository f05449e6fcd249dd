#include "mechanics/mass_matrix/symbolic_factors.h"

#include "algebra/simplify.h"
#include "base/memory.h"

/* D_j = K_jj - sum_k L_jk^2 D_k,  L_ij = (K_ij - sum_k L_ik L_jk D_k) / D_j */
Node *factors_create(struct Graph *graph, const struct FactorPattern *pattern, const Node *elements) {
  const size_t *start = pattern->start, *column = pattern->column;
  Node *factor = allocate(start[pattern->count], sizeof *factor), *row = allocate(pattern->count, sizeof *row);
  for (size_t i = 0; i < pattern->count; i++) {
    size_t diagonal = start[i + 1] - 1;
    Node pivot = elements[diagonal];
    for (size_t k = start[i]; k < diagonal; k++) {
      size_t j = column[k], end = start[j + 1] - 1;
      Node product = elements[k]; /* L_ij D_j */
      for (size_t l = start[j]; l < end; l++) {
        Node part = multiply(graph, row[column[l]], factor[start[column[l] + 1] - 1]);
        product = subtract(graph, product, multiply(graph, part, factor[l]));
      }
      factor[k] = row[j] = divide(graph, product, factor[end]);
      pivot = subtract(graph, pivot, multiply(graph, factor[k], product));
    }
    factor[diagonal] = pivot;
    for (size_t k = start[i]; k < diagonal; k++) row[column[k]] = ZERO;
  }
  return factor;
}

void factors_solve(struct Graph *graph, const struct FactorPattern *pattern, const Node *factors, Node *x) {
  const size_t *start = pattern->start, *column = pattern->column;
  for (size_t i = 0; i < pattern->count; i++)
    for (size_t k = start[i]; k + 1 < start[i + 1]; k++)
      x[i] = subtract(graph, x[i], multiply(graph, factors[k], x[column[k]]));
  for (size_t i = 0; i < pattern->count; i++) x[i] = divide(graph, x[i], factors[start[i + 1] - 1]);
  for (size_t i = pattern->count; i-- > 0;)
    for (size_t k = start[i]; k + 1 < start[i + 1]; k++) {
      size_t j = column[k];
      x[j] = subtract(graph, x[j], multiply(graph, factors[k], x[i]));
    }
}
