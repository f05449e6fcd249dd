/*
 * Factors and solves saddle point systems K (a, F) = b with K = (M J^T; J 0), where constraints may be redundant (M.
 * Benzi, G. H. Golub, J. Liesen: Numerical solution of saddle point problems, Acta Numerica 14, 2005, gives an
 * overview).
 *
 * K = L D L^T exists without pivoting, since each constraint comes after its coordinates. Its pivot is minus what
 * remains of its diagonal element of J M^-1 J^T. It costs the multiplications of the sparse pattern.
 *
 * If nothing remains, up to rounding, the constraint is redundant: its pivot becomes infinite, and its force 0. For
 * such a row i, L^-T e_i holds forces z with J^T z = 0. Orthogonalized, they are a basis of the null space of J^T.
 * Subtracting from the forces their parts along the basis gives those of least Euclidean norm with the same J^T F.
 *
 * The force of a quaternion's norm takes that part of other forces that would only stretch the quaternion. It depends
 * on the choice of the frame, so that it has no part in z; restore_load() sets it.
 */
#include "saddle.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "ldlt.h"

/* K: row i has the elements start[i] .. start[i + 1] - 1. */
struct Given {
  const size_t *start, *column;
  const Real *matrix;
};

static struct Given given_of(size_t n, const size_t *start, const size_t *column, const Real *m) {
  const size_t *first = column + start[n];
  return (struct Given){.start = first, .column = first + n + 1, .matrix = m + start[n]};
}

/* Returns the offset of the smallest relative pivot, which follows L and K. */
static size_t slot_of_weakest(size_t n, const size_t *start, const size_t *column) {
  return start[n] + column[start[n] + n];
}

/*
 * The rows in use: those of coordinates, and of constraints whose row of K is not 0. If there are others, as most
 * contacts of a heap are open, L below its diagonal is packed: without the elements that are 0. A list follows the
 * packed elements. It has the number of rows in use, these rows, and 1 if L is packed. Then come the number with which
 * each packed row begins, and the columns of the elements.
 */
struct Packed {
  size_t n;
  Real *element, *list;
};

static struct Packed packed_of(size_t n, const size_t *start, const size_t *column, const Real *m) {
  Real *element = (Real *)m + slot_of_weakest(n, start, column) + 1 + 2 * n;
  return (struct Packed){.n = n, .element = element, .list = element + start[n]};
}

/* The list has numbers of half the size of a double. */
static size_t listed(const struct Packed *packed, size_t i) {
  uint32_t number;
  memcpy(&number, (const char *)packed->list + i * sizeof number, sizeof number);
  return number;
}

static void list(const struct Packed *packed, size_t i, size_t listed_number) {
  const uint32_t number = (uint32_t)listed_number;
  memcpy((char *)packed->list + i * sizeof number, &number, sizeof number);
}

static size_t used_count(const struct Packed *packed) {
  return listed(packed, 0);
}

static size_t used_row(const struct Packed *packed, size_t i) {
  return listed(packed, 1 + i);
}

static bool is_packed(const struct Packed *packed) {
  return listed(packed, 1 + packed->n) == 1;
}

static size_t packed_start(const struct Packed *packed, size_t row) {
  return listed(packed, 2 + packed->n + row);
}

static size_t packed_column(const struct Packed *packed, size_t k) {
  return listed(packed, 3 + 2 * packed->n + k);
}

static void begin_list(const struct Packed *packed, bool packs) {
  list(packed, 0, 0);
  list(packed, 1 + packed->n, packs ? 1 : 0);
  list(packed, 2 + packed->n, 0);
}

/* Takes the next row into use. */
static void use_row(const struct Packed *packed, size_t i) {
  size_t count = used_count(packed);
  list(packed, 1 + count, i);
  list(packed, 0, count + 1);
}

/* Packs the next row of L. */
static void pack_row(const struct Packed *packed, const size_t *start, const size_t *column, const Real *m, size_t i) {
  size_t end = packed_start(packed, i);
  for (size_t k = start[i]; k + 1 < start[i + 1]; k++) {
    Condition is_part = m[k] != 0.0;
    if (!ANYWHERE(is_part)) continue;
    packed->element[end] = m[k];
    list(packed, 3 + 2 * packed->n + end++, column[k]);
  }
  list(packed, 3 + packed->n + i, end);
}

/* Packs the next row, that of a constraint without elements of K. */
static void pack_empty_row(const struct Packed *packed, size_t i) {
  list(packed, 3 + packed->n + i, packed_start(packed, i));
}

/* Subtracts K x from rest, with the rows of K below n. */
static void subtract_product(size_t n, const struct Packed *packed, const struct Given *given, const Real *x,
                             Real *rest) {
  size_t count = used_count(packed);
  for (size_t used = 0; used < count && used_row(packed, used) < n; used++) {
    size_t i = used_row(packed, used);
    for (size_t k = given->start[i]; k < given->start[i + 1]; k++) {
      size_t j = given->column[k];
      rest[i] -= given->matrix[k] * x[j];
      if (i != j) rest[j] -= given->matrix[k] * x[i];
    }
  }
}

/* Subtracts a multiple of row i of L below its diagonal from x. */
static void subtract_row(const struct Packed *packed, const size_t *start, const size_t *column, const Real *m,
                         size_t i, Real share, Real *x) {
  if (!is_packed(packed)) {
    for (size_t k = start[i]; k + 1 < start[i + 1]; k++) x[column[k]] -= m[k] * share;
    return;
  }
  size_t end = packed_start(packed, i + 1);
  for (size_t k = packed_start(packed, i); k < end; k++) x[packed_column(packed, k)] -= packed->element[k] * share;
}

/* Solves L D L^T x = b in the rows below n, in place. */
static void solve_below(size_t n, const struct Packed *packed, const size_t *start, const size_t *column, const Real *m,
                        Real *x) {
  if (!is_packed(packed)) {
    ldlt_solve(n, start, column, m, x);
    return;
  }
  size_t count = used_count(packed);
  for (size_t used = 0; used < count && used_row(packed, used) < n; used++) {
    size_t i = used_row(packed, used);
    if (ldlt_is_idle(m[start[i + 1] - 1])) continue;
    size_t end = packed_start(packed, i + 1);
    for (size_t k = packed_start(packed, i); k < end; k++) x[i] -= packed->element[k] * x[packed_column(packed, k)];
  }
  for (size_t i = 0; i < n; i++) x[i] /= m[start[i + 1] - 1];
  for (size_t used = count; used-- > 0;) {
    size_t i = used_row(packed, used);
    if (i >= n || ldlt_is_idle(m[start[i + 1] - 1])) continue;
    subtract_row(packed, start, column, m, i, x[i], x);
  }
}

/* Computes x = L^-T e_i in the rows up to i. */
static void combine(const struct Packed *packed, const size_t *start, const size_t *column, const Real *m, size_t i,
                    Real *x) {
  memset(x, 0, i * sizeof *x);
  x[i] = REAL(1.0);
  for (size_t row = i + 1; row-- > 0;) {
    Condition has_part = x[row] != 0.0;
    if (ANYWHERE(has_part)) subtract_row(packed, start, column, m, row, x[row], x);
  }
}

/* Returns w^T M w of the coordinates before row i. */
static Real square_by_mass(const int *coordinate, const struct Given *given, size_t i, const Real *w) {
  Real sum = REAL(0.0);
  for (size_t row = 0; row < i; row++)
    for (size_t k = given->start[row]; coordinate[row] > 0 && k < given->start[row + 1]; k++) {
      size_t j = given->column[k];
      if (coordinate[j] > 0) sum += (j == row ? 1.0 : 2.0) * w[row] * given->matrix[k] * w[j];
    }
  return sum;
}

/*
 * Returns minus the pivot of constraint i as w^T M w, where w is the motion that the constraints before it leave free
 * along it. This has the digits of w, while the pivot is a difference of squares. w is refined once by its residual.
 */
static Real refined_pivot(const struct Packed *packed, const size_t *start, const size_t *column, const int *coordinate,
                          const Real *m, const struct Given *given, size_t i, Real *w) {
  Real *rest = w + i + 1;
  combine(packed, start, column, m, i, w);
  memset(rest, 0, (i + 1) * sizeof *rest);
  subtract_product(i + 1, packed, given, w, rest);
  solve_below(i, packed, start, column, m, rest);
  for (size_t row = 0; row < i; row++) w[row] += rest[row];
  return square_by_mass(coordinate, given, i, w);
}

/* True if a row of K has elements that are not 0. That of an open contact has none, and takes no part. */
static Condition has_row(const struct Given *given, size_t i) {
  Real sum = REAL(0.0);
  for (size_t k = given->start[i]; k < given->start[i + 1]; k++) sum += fabs(given->matrix[k]);
  return sum != 0.0;
}

/*
 * Returns the offset of the null-space vector of constraint c of those in use. The vectors follow the workspace and the
 * packed rows.
 */
static size_t slot_of_null_vector(size_t n, const size_t *start, const size_t *column, size_t c) {
  return slot_of_weakest(n, start, column) + 1 + 2 * n + SADDLE_PACKED(start[n], n) + c * (c + 1) / 2;
}

/* Returns the component of c + 1 forces along a null-space vector, in units of the vector. */
static Real component_along(size_t c, const Real *null_vector, const Real *force) {
  Real product = force[c];
  for (size_t k = 0; k < c; k++) product += null_vector[k] * force[k];
  return product * null_vector[c];
}

/* Subtracts from the forces their part along a null-space vector. */
static void subtract_component(size_t c, const Real *null_vector, Real *force) {
  if (!ANYWHERE(null_vector[c] > 0.0)) return;
  Real share = component_along(c, null_vector, force);
  for (size_t k = 0; k < c; k++) force[k] -= share * null_vector[k];
  force[c] -= share;
}

/*
 * Computes the null-space vector of constraint c of those in use, in row i, if it is redundant: L^-T e_i without the
 * forces of norms. It is orthogonalized against those before it, twice because of rounding. It has an element for each
 * constraint in use up to c. The element of c is 1 and is not stored; its slot holds 1 / |vector|^2, or 0 if there is
 * no vector.
 */
static void find_null_vector(size_t n, const size_t *start, const size_t *column, const int *coordinate, Real *m,
                             size_t i, size_t c, Condition has_row_of_k) {
  Real *null_vector = m + slot_of_null_vector(n, start, column, c), length = REAL(1.0);
  Real *forces = m + slot_of_weakest(n, start, column) + 1;
  Condition follows = BOTH(m[start[i + 1] - 1] == -INFINITY, has_row_of_k);
  null_vector[c] = REAL(0.0);
  if (!ANYWHERE(follows)) return;
  const struct Packed packed = packed_of(n, start, column, m);
  combine(&packed, start, column, m, i, forces);
  for (size_t used = 0, k = 0; k < c; used++) {
    size_t row = used_row(&packed, used);
    if (coordinate[row] < 0) null_vector[k++] = coordinate[row] == SADDLE_NORM ? REAL(0.0) : forces[row];
  }
  null_vector[c] = REAL(1.0);
  for (size_t j = 0; j < 2 * c; j++)
    subtract_component(j % c, m + slot_of_null_vector(n, start, column, j % c), null_vector);
  for (size_t k = 0; k < c; k++) length += null_vector[k] * null_vector[k];
  null_vector[c] = WHERE(follows, 1.0 / length, 0.0);
}

void saddle_null_vector(size_t n, const size_t *start, const size_t *column, const int *coordinate, Real *m) {
  const struct Given given = given_of(n, start, column, m);
  const struct Packed packed = packed_of(n, start, column, m);
  begin_list(&packed, false);
  for (size_t i = 0, c = 0; i < n; i++) {
    Condition takes_part = has_row(&given, i);
    if (coordinate[i] < 0 && !ANYWHERE(takes_part)) continue;
    use_row(&packed, i);
    if (coordinate[i] < 0) find_null_vector(n, start, column, coordinate, m, i, c++, takes_part);
  }
}

/* Returns the product of row j of L below its diagonal with spread. */
static Real product_of_row(const size_t *start, const size_t *column, const Real *m, size_t j, const Real *spread) {
  Real sum = REAL(0.0);
  for (size_t e = start[j + 1] - 1; e-- > start[j];) sum += m[e] * spread[column[e]];
  return sum;
}

static Real product_of_packed(const struct Packed *packed, size_t j, const Real *spread) {
  Real sum = REAL(0.0);
  size_t first = packed_start(packed, j);
  for (size_t e = packed_start(packed, j + 1); e-- > first;)
    sum += packed->element[e] * spread[packed_column(packed, e)];
  return sum;
}

/* Rows from which on packing may pay. */
enum { PACKED_ROWS = 50 };

/* True if packing pays: the row of a constraint is 0. */
static bool is_to_pack(size_t n, const int *coordinate, const struct Given *given) {
  bool any = false;
  if (n < PACKED_ROWS) return false;
  for (size_t i = 0; i < n && !any; i++) {
    Condition takes_part = has_row(given, i);
    any = coordinate[i] < 0 && !ANYWHERE(takes_part);
  }
  return any;
}

/*
 * Computes the elements L_ij D_j of row i before the diagonal, and K_ii on it. spread: n numbers, all 0 before and
 * afterwards, which hold the row by columns, so that products with the rows j need no search for common columns.
 */
static void eliminate_row(const struct Packed *packed, const size_t *start, const size_t *column, Real *m,
                          const struct Given *given, size_t i, Real *spread) {
  size_t last = start[i + 1] - 1;
  bool has_list = is_packed(packed);
  for (size_t k = given->start[i]; k < given->start[i + 1]; k++) spread[given->column[k]] = given->matrix[k];
  for (size_t k = start[i]; k < last; k++) {
    size_t j = column[k], diagonal = start[j + 1] - 1;
    if (ldlt_is_idle(m[diagonal])) continue;
    spread[j] -= has_list ? product_of_packed(packed, j, spread) : product_of_row(start, column, m, j, spread);
  }
  for (size_t k = start[i]; k <= last; k++) {
    m[k] = spread[column[k]];
    spread[column[k]] = REAL(0.0);
  }
}

size_t saddle_factor(size_t n, const size_t *start, const size_t *column, const int *coordinate, Real *m) {
  const struct Given given = given_of(n, start, column, m);
  Real *weakest = m + slot_of_weakest(n, start, column), *work = weakest + 1, *spread = work + n;
  const struct Packed packed = packed_of(n, start, column, m);
  *weakest = REAL(1.0);
  memset(spread, 0, n * sizeof *spread);
  bool packs = is_to_pack(n, coordinate, &given);
  begin_list(&packed, packs);
  for (size_t i = 0, c = 0; i < n; i++) {
    size_t last = start[i + 1] - 1;
    Condition takes_part = has_row(&given, i);
    if (coordinate[i] < 0 && !ANYWHERE(takes_part)) {
      m[last] = REAL(-INFINITY);
      if (packs) pack_empty_row(&packed, i);
      continue;
    }
    use_row(&packed, i);
    eliminate_row(&packed, start, column, m, &given, i, spread);
    Real diagonal = m[last], pivot = diagonal, delassus = REAL(0.0);
    for (size_t k = start[i]; k < last; k++) {
      Real l = m[k] / m[start[column[k] + 1] - 1], term = l * m[k];
      pivot -= term;
      delassus += saddle_delassus(term);
      m[k] = l;
    }
    if (packs) pack_row(&packed, start, column, m, i);
    if (coordinate[i] > 0) {
      REQUIRE(saddle_is_definite(pivot, diagonal), i + 1);
      m[last] = pivot;
      continue;
    }
    Real hold = -pivot;
    Condition doubts = saddle_is_doubtful(hold, delassus, *weakest);
    if (ANYWHERE(doubts)) {
      hold = WHERE(doubts, refined_pivot(&packed, start, column, coordinate, m, &given, i, work), hold);
      memset(spread, 0, n * sizeof *spread);
    }
    m[last] = saddle_pivot(hold, delassus, weakest);
    find_null_vector(n, start, column, coordinate, m, i, c++, takes_part);
  }
  return 0;
}

void saddle_solve(size_t n, const size_t *start, const size_t *column, const Real *m, Real *x) {
  Real *rest = x + n;
  const struct Given given = given_of(n, start, column, m);
  Condition is_weak = saddle_is_weak(slot_of_weakest(n, start, column), m);
  bool is_refined = ANYWHERE(is_weak);
  if (is_refined) memcpy(rest, x, n * sizeof *rest);
  const struct Packed packed = packed_of(n, start, column, m);
  solve_below(n, &packed, start, column, m, x);
  if (!is_refined) return;
  subtract_product(n, &packed, &given, x, rest);
  solve_below(n, &packed, start, column, m, rest);
  for (size_t i = 0; i < n; i++) x[i] = WHERE(is_weak, x[i] + rest[i], x[i]);
}

/* Subtracts from the forces in x their parts along all null-space vectors. */
static void shorten_forces(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                           Real *x) {
  const struct Packed packed = packed_of(n, start, column, m);
  Real *force = x + n;
  size_t count = 0, used = used_count(&packed);
  for (size_t k = 0; k < used; k++)
    if (coordinate[used_row(&packed, k)] < 0) force[count++] = x[used_row(&packed, k)];
  for (size_t c = 0; c < count; c++) subtract_component(c, m + slot_of_null_vector(n, start, column, c), force);
  while (used-- > 0)
    if (coordinate[used_row(&packed, used)] < 0) x[used_row(&packed, used)] = force[--count];
}

/* Corrects the forces in x so that they have the same J^T F as others. */
static void restore_load(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                         const Real *others, Real *x) {
  const struct Given given = given_of(n, start, column, m);
  Real *missing = x + n, *load = missing + n;
  for (size_t i = 0; i < n; i++) {
    missing[i] = coordinate[i] < 0 ? x[i] - others[i] : REAL(0.0);
    load[i] = REAL(0.0);
  }
  const struct Packed packed = packed_of(n, start, column, m);
  subtract_product(n, &packed, &given, missing, load);
  for (size_t i = 0; i < n; i++) missing[i] = coordinate[i] < 0 ? REAL(0.0) : load[i];
  saddle_solve(n, start, column, m, missing);
  for (size_t i = 0; i < n; i++)
    if (coordinate[i] < 0) x[i] += missing[i];
}

static bool has_null_vectors(size_t n, const size_t *start, const size_t *column, const int *coordinate,
                             const Real *m) {
  const struct Packed packed = packed_of(n, start, column, m);
  size_t count = used_count(&packed);
  bool has = false;
  for (size_t k = 0, c = 0; k < count && !has; k++)
    if (coordinate[used_row(&packed, k)] < 0) {
      has = ANYWHERE(m[slot_of_null_vector(n, start, column, c) + c] > 0.0);
      c++;
    }
  return has;
}

/*
 * The null-space vectors lose digits if other constraints are nearly redundant. So J^T F is restored once, and the
 * result shortened again.
 */
void saddle_least_forces(size_t n, const size_t *start, const size_t *column, const int *coordinate, const Real *m,
                         Real *x) {
  Real *given = x + 3 * n;
  if (!has_null_vectors(n, start, column, coordinate, m)) return;
  memcpy(given, x, n * sizeof *given);
  shorten_forces(n, start, column, coordinate, m, x);
  restore_load(n, start, column, coordinate, m, given, x);
  shorten_forces(n, start, column, coordinate, m, x);
}
