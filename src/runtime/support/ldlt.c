#include "ldlt.h"

/* A pivot below this fraction of its diagonal element has lost all its digits. */
static const double smallest_pivot = 1e-14;

static size_t factor_full(size_t n, Real *m) {
  for (size_t i = 0; i < n; i++) {
    Real *row = m + i * (i + 1) / 2;
    Real diagonal = row[i], pivot = diagonal;
    for (size_t j = 0; j < i; j++) {
      const Real *other = m + j * (j + 1) / 2;
      Real product = row[j]; /* becomes L_ij D_j; the elements before it hold L_ik D_k */
      for (size_t k = 0; k < j; k++) product -= row[k] * other[k];
      row[j] = product;
    }
    for (size_t j = 0; j < i; j++) {
      Real l = row[j] / m[j * (j + 1) / 2 + j];
      pivot -= l * row[j];
      row[j] = l;
    }
    REQUIRE(pivot > smallest_pivot * diagonal, i + 1);
    row[i] = pivot;
  }
  return 0;
}

/*
 * Returns the sum of L_ik D_k L_jk over the columns k < j that rows i and j share. Row j holds L there, row i holds L
 * D. slot is the index of column j in row i.
 */
static Real product_of_rows(const size_t *start, const size_t *column, const Real *m, size_t i, size_t slot) {
  size_t j = column[slot], a = slot, b = start[j + 1] - 1;
  Real sum = REAL(0.0);
  while (a > start[i] && b > start[j]) {
    if (column[a - 1] > column[b - 1]) a--;
    else if (column[a - 1] < column[b - 1]) b--;
    else sum += m[--a] * m[--b];
  }
  return sum;
}

size_t ldlt_factor(size_t n, const size_t *start, const size_t *column, Real *m) {
  if (start == NULL) return factor_full(n, m);
  for (size_t i = 0; i < n; i++) {
    size_t last = start[i + 1] - 1;
    Real diagonal = m[last], pivot = diagonal;
    for (size_t k = start[i]; k < last; k++) m[k] -= product_of_rows(start, column, m, i, k);
    for (size_t k = start[i]; k < last; k++) {
      Real l = m[k] / m[start[column[k] + 1] - 1];
      pivot -= l * m[k];
      m[k] = l;
    }
    REQUIRE(pivot > smallest_pivot * diagonal, i + 1);
    m[last] = pivot;
  }
  return 0;
}

static void solve_full(size_t n, const Real *restrict m, Real *restrict x) {
  const Real *row = m;
  for (size_t i = 0; i < n; row += ++i) {
    Real rest = x[i];
    for (size_t k = 0; k < i; k++) rest -= row[k] * x[k];
    x[i] = rest;
  }
  for (size_t i = 0; i < n; i++) x[i] /= m[i * (i + 1) / 2 + i];
  for (size_t i = n; i-- > 0;) {
    const Real known = x[i];
    row -= i + 1;
    for (size_t k = 0; k < i; k++) x[k] -= row[k] * known;
  }
}

void ldlt_solve(size_t n, const size_t *start, const size_t *column, const Real *m, Real *x) {
  if (start == NULL) {
    solve_full(n, m, x);
    return;
  }
  for (size_t i = 0; i < n; i++) {
    if (ldlt_is_idle(m[start[i + 1] - 1])) continue;
    for (size_t k = start[i]; k + 1 < start[i + 1]; k++) x[i] -= m[k] * x[column[k]];
  }
  for (size_t i = 0; i < n; i++) x[i] /= m[start[i + 1] - 1];
  for (size_t i = n; i-- > 0;) {
    if (ldlt_is_idle(m[start[i + 1] - 1])) continue;
    for (size_t k = start[i]; k + 1 < start[i + 1]; k++) x[column[k]] -= m[k] * x[i];
  }
}
