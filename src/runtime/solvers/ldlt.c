#include "ldlt.h"

/* A pivot below this share of its diagonal element has lost all its digits. */
static const double rounding = 1e-14;

size_t ldlt_factor(size_t n, double *m) {
  for (size_t i = 0; i < n; i++) {
    double *row = m + i * (i + 1) / 2;
    double diagonal = row[i], pivot = diagonal;
    for (size_t j = 0; j < i; j++) {
      const double *other = m + j * (j + 1) / 2;
      double product = row[j]; /* becomes L_ij D_j; the elements before it hold L_ik D_k */
      for (size_t k = 0; k < j; k++) product -= row[k] * other[k];
      row[j] = product;
    }
    for (size_t j = 0; j < i; j++) {
      double l = row[j] / m[j * (j + 1) / 2 + j];
      pivot -= l * row[j];
      row[j] = l;
    }
    if (!(pivot > rounding * diagonal)) return i + 1;
    row[i] = pivot;
  }
  return 0;
}

void ldlt_solve(size_t n, const double *m, double *x) {
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < i; k++) x[i] -= m[i * (i + 1) / 2 + k] * x[k];
  for (size_t i = 0; i < n; i++) x[i] /= m[i * (i + 1) / 2 + i];
  for (size_t i = n; i-- > 0;)
    for (size_t k = 0; k < i; k++) x[k] -= m[i * (i + 1) / 2 + k] * x[i];
}
