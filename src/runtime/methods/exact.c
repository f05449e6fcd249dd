/*
 * Linear systems x' = A x + B u + c, whose inputs u are polynomials over the step, by the matrix exponential. With z =
 * (x, 1, u, u', u'', u''') the system is z' = Z z, and z(h) = exp(Z h) z(0) (C. F. Van Loan: Computing integrals
 * involving the matrix exponential, IEEE Trans. Automatic Control 23, 1978).
 *
 * exp(Z h) comes from scaling and squaring (C. Moler, C. Van Loan: Nineteen dubious ways to compute the exponential of
 * a matrix, SIAM Review 20, 1978, method 3). Balancing and k halvings reduce the norm to 1/2 or less, where the Taylor
 * series ends after some twenty terms; k squarings follow. With n rows this costs O(n^3) for each product, in long
 * double. The matrix is kept while step and parameters stay, and a step then costs O(n^2).
 *
 * Two measures keep the error of many steps near the rounding of the phase. A step adds the change (exp(Z h) - I) z,
 * whose rounding error is small in short steps; squaring keeps the form exp - I. Compensated summation (Kahan) carries
 * the rounding error of the state in the snapshot.
 */
#include <math.h>
#include <string.h>

#include "evaluation/inputs.h"
#include "evaluation/services.h"
#include "instance/snapshot.h"
#include "instance/time_laws.h"
#include "support/arena.h"

/* State of the method. With the same step and parameters, the matrix is used again. The arrays follow, aligned. */
struct Exact {
  _Alignas(long double) size_t order; /* 1 + INPUT_ORDER if the matrix takes input derivatives, else 1 */
  double step;                        /* of the matrix, in s; 0 if there is none */
  double *parameter;                  /* of the matrix; parameter_count */
  /* exp(Z h) = diag(identity) + matrix: its first state_count rows, each of extended_size(order) columns. */
  double *identity, *matrix;
  double *extended, *linear;
  double *state;           /* at the start of the step */
  double *next, *next_low; /* the state at the end of the step, and its rounding error */
  /* Workspace of the exponential: size x size each, by rows, and size exponents of 2. */
  long double *generator, *term, *product, *sum;
  int *exponent;
};

static size_t extended_size(size_t order) {
  return lagrangian.state_count + 1 + order * lagrangian.input_count;
}

static size_t saved_size(void) {
  return lagrangian.state_count * sizeof(double); /* the rounding error of the state */
}

static bool is_saved_valid(const struct FmuState *fmu_state, const void *saved) {
  (void)fmu_state;
  return snapshot_is_finite(saved, lagrangian.state_count);
}

static size_t lay_out_exact(struct Exact *exact, void *block) {
  size_t states = lagrangian.state_count, size = extended_size(1 + INPUT_ORDER);
  struct Arena arena = {(uintptr_t)block};
  ARENA_TAKE(&arena, exact->generator, size * size);
  ARENA_TAKE(&arena, exact->term, size * size);
  ARENA_TAKE(&arena, exact->product, size * size);
  ARENA_TAKE(&arena, exact->sum, size * size);
  ARENA_NUMBERS(&arena, lagrangian.parameter_count, &exact->parameter);
  ARENA_NUMBERS(&arena, states, &exact->identity, &exact->next, &exact->next_low, &exact->state);
  ARENA_NUMBERS(&arena, states * size, &exact->matrix);
  ARENA_NUMBERS(&arena, size, &exact->extended);
  ARENA_NUMBERS(&arena, states * (states + lagrangian.input_count + 1), &exact->linear);
  ARENA_TAKE(&arena, exact->exponent, size);
  return arena.next - (uintptr_t)block;
}

static bool create(struct Instance *instance) {
  struct Exact counted, *exact = instance->memory.allocate(1, sizeof *exact + lay_out_exact(&counted, NULL));
  if (exact == NULL) return solver_is_out_of_memory(instance);
  lay_out_exact(exact, exact + 1);
  instance->solver_memory = exact;
  return true;
}

/* Computes result = a b for n x n matrices by rows. A zero in a gives 0 even for infinite elements of b. */
static void multiply(size_t n, const long double *a, const long double *b, long double *result) {
  for (size_t i = 0; i < n * n; i++) result[i] = 0.0L;
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < n; k++) {
      long double factor = a[i * n + k];
      if (factor == 0.0L) continue;
      for (size_t j = 0; j < n; j++) result[i * n + j] += factor * b[k * n + j];
    }
}

/* Sets the generator Z h; its columns are x, 1, u, u', ... */
static void fill_generator(struct Instance *instance, struct Exact *exact, double step) {
  size_t states = lagrangian.state_count, inputs = lagrangian.input_count, n = extended_size(exact->order);
  size_t columns = states + inputs + 1;
  lagrangian.linear(instance->parameter, instance->parameter_constants, exact->linear);
  for (size_t i = 0; i < n * n; i++) exact->generator[i] = 0.0L;
  for (size_t i = 0; i < states; i++) {
    long double *row = exact->generator + i * n;
    const double *source = exact->linear + i * columns;
    for (size_t j = 0; j < states; j++) row[j] = (long double)step * source[j];
    row[states] = (long double)step * source[states + inputs];
    for (size_t j = 0; j < inputs; j++) row[states + 1 + j] = (long double)step * source[states + j];
  }
  for (size_t i = states + 1; i + inputs < n; i++) exact->generator[i * n + i + inputs] = step;
}

/* Returns the exponent of 2 for column i, and its negative for row i, that makes their norms about equal. */
static int balancing_exponent(size_t n, const long double *a, size_t i) {
  long double row = 0.0L, column = 0.0L;
  for (size_t j = 0; j < n; j++) {
    if (j == i) continue;
    row += fabsl(a[i * n + j]);
    column += fabsl(a[j * n + i]);
  }
  if (row == 0.0L && column == 0.0L) return 0;
  /* A constant, or a variable on which nothing depends, may have any scale. */
  if (row == 0.0L) return ilogbl(column) > 0 ? -ilogbl(column) : 0;
  if (column == 0.0L) return ilogbl(row) > 0 ? ilogbl(row) : 0;
  return (ilogbl(row) - ilogbl(column)) / 2;
}

/*
 * Replaces a by D^-1 a D with D = diag(2^exponent), of smaller norm, so that fewer halvings are needed (E. E. Osborne:
 * On pre-conditioning of matrices, Journal of the ACM 7, 1960). Powers of two add no rounding error. A few sweeps
 * suffice.
 */
static void balance(size_t n, long double *a, int *exponent) {
  enum { SWEEPS = 50 };
  bool changed = true;
  for (int sweep = 0; sweep < SWEEPS && changed; sweep++) {
    changed = false;
    for (size_t i = 0; i < n; i++) {
      int shift = balancing_exponent(n, a, i);
      if (shift == 0) continue;
      changed = true;
      exponent[i] += shift;
      long double factor = ldexpl(1.0L, shift);
      for (size_t j = 0; j < n; j++) {
        if (j == i) continue;
        a[j * n + i] *= factor;
        a[i * n + j] /= factor;
      }
    }
  }
}

static long double row_norm(size_t n, const long double *a) {
  long double largest = 0.0L;
  for (size_t i = 0; i < n; i++) {
    long double row = 0.0L;
    for (size_t j = 0; j < n; j++) row += fabsl(a[i * n + j]);
    if (!(row <= largest)) largest = row;
  }
  return largest;
}

/* Sets sum = exp(generator) - I by the Taylor series, for a norm below 1. Ends when no element changes. */
static void sum_exponential(struct Exact *exact, size_t n) {
  memcpy(exact->sum, exact->generator, n * n * sizeof *exact->sum);
  memcpy(exact->term, exact->generator, n * n * sizeof *exact->term);
  bool changed = true;
  for (int k = 2; changed; k++) {
    changed = false;
    multiply(n, exact->term, exact->generator, exact->product);
    long double factor = 1.0L / k;
    for (size_t i = 0; i < n * n; i++) {
      exact->term[i] = factor * exact->product[i];
      if (exact->term[i] == 0.0L) continue;
      long double before = exact->sum[i];
      exact->sum[i] += exact->term[i];
      changed |= exact->sum[i] != before;
    }
  }
}

/*
 * Squares E = diag(identity) + sum, with identity elements 0 or 1: sum becomes E^2 - diag(identity). Near the identity,
 * sum keeps digits that E would lose. For a variable that has decayed below 1/2, E itself does, and identity becomes 0.
 */
static void square(struct Exact *exact, size_t n, double *identity) {
  long double *sum = exact->sum;
  for (size_t i = 0; i < n; i++) {
    if (identity[i] == 0.0 || sum[i * n + i] > -0.5L) continue;
    identity[i] = 0.0;
    sum[i * n + i] += 1.0L;
  }
  multiply(n, sum, sum, exact->product);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      sum[i * n + j] = exact->product[i * n + j] + (identity[i] + identity[j]) * sum[i * n + j];
}

/* Balances and halves the generator to a norm of at most 1/2. Returns the number of halvings, -1 if not finite. */
static int reduce(struct Exact *exact, size_t n) {
  memset(exact->exponent, 0, n * sizeof *exact->exponent);
  long double size = row_norm(n, exact->generator);
  if (size <= 0.5L) return 0;
  if (!isfinite(size)) return -1;
  balance(n, exact->generator, exact->exponent);
  size = row_norm(n, exact->generator);
  int halvings = size > 0.5L ? ilogbl(size) + 2 : 0;
  long double factor = ldexpl(1.0L, -halvings);
  for (size_t i = 0; i < n * n; i++) exact->generator[i] *= factor;
  return halvings;
}

/* Computes identity and matrix of exp(generator). False if an element is not finite. */
static bool exponentiate(struct Exact *exact, size_t n) {
  size_t states = lagrangian.state_count;
  int halvings = reduce(exact, n);
  if (halvings < 0) return false;
  sum_exponential(exact, n);
  double *identity = exact->extended; /* of all n variables */
  for (size_t i = 0; i < n; i++) identity[i] = 1.0;
  for (int i = 0; i < halvings; i++) square(exact, n, identity);
  memcpy(exact->identity, identity, states * sizeof *identity);
  double total = 0.0;
  for (size_t i = 0; i < states; i++)
    for (size_t j = 0; j < n; j++) {
      double *element = &exact->matrix[i * n + j];
      *element = (double)ldexpl(exact->sum[i * n + j], exact->exponent[i] - exact->exponent[j]);
      total += *element - *element; /* NaN if one is not finite */
    }
  return total == 0.0;
}

/* Updates the matrix if step or parameters have changed. False if it is not finite. */
static bool prepare_matrix(struct Instance *instance, struct Exact *exact, double step) {
  size_t bytes = lagrangian.parameter_count * sizeof(double);
  size_t order = instance->fmu_state->input_derivatives_set ? 1 + INPUT_ORDER : 1;
  if (exact->step == step && exact->order == order && memcmp(exact->parameter, instance->parameter, bytes) == 0)
    return true;
  exact->order = order;
  fill_generator(instance, exact, step);
  exact->step = exponentiate(exact, extended_size(order)) ? step : 0.0;
  memcpy(exact->parameter, instance->parameter, bytes);
  return exact->step != 0.0;
}

/* Computes the inputs and their time derivatives of orders 0 to count - 1 at a time, order by order. */
static void fill_inputs(const struct Instance *instance, double time, size_t count, double *values) {
  double coefficient[INPUT_ORDER + 1];
  static const double factorial[INPUT_ORDER + 1] = {1.0, 1.0, 2.0, 6.0};
  for (size_t i = 0; i < lagrangian.input_count; i++) {
    expand_input(instance, i, time, coefficient);
    for (size_t order = 0; order < count; order++)
      values[order * lagrangian.input_count + i] = factorial[order] * coefficient[order];
  }
}

/* Computes next = exp(Z h) extended from the state, and next_low, its rounding error. False if it is not finite. */
static bool compute_next(struct Instance *instance, struct Exact *exact, double step) {
  size_t states = lagrangian.state_count;
  if (!prepare_matrix(instance, exact, step)) return false;
  size_t n = extended_size(exact->order);
  const double *low = instance->saved;
  memcpy(exact->extended, exact->state, states * sizeof(double));
  exact->extended[states] = 1.0;
  fill_inputs(instance, instance->fmu_state->last_step.start, exact->order, exact->extended + states + 1);
  double total = 0.0;
  const double *element = exact->matrix, *extended = exact->extended;
  for (size_t i = 0; i < states; i++) {
    double before = exact->identity[i] * extended[i], term = exact->identity[i] * low[i];
    for (size_t j = 0; j < n; j++) term += *element++ * extended[j];
    double sum = before + term, part = sum - before;
    exact->next_low[i] = (before - (sum - part)) + (term - part);
    exact->next[i] = sum;
    total += sum - sum; /* NaN if one is not finite */
  }
  return total == 0.0;
}

/* Returns the longest step with a finite end by bisection, to 1e-6 of length. */
static double longest_step(struct Instance *instance, struct Exact *exact, double length) {
  double possible = 0.0, impossible = length;
  while (impossible - possible > 1e-6 * length) {
    double middle = possible + (impossible - possible) / 2.0;
    if (compute_next(instance, exact, middle)) possible = middle;
    else impossible = middle;
  }
  return possible;
}

static bool restart(struct Instance *instance, const double *state, const struct CommunicationStep *step) {
  struct Exact *exact = instance->solver_memory;
  (void)step;
  memcpy(exact->state, state, lagrangian.state_count * sizeof *state);
  memcpy(exact->next, state, lagrangian.state_count * sizeof *state);
  return true;
}

/* Advances to the end of the communication step, the next sample, or as far as the state is finite. */
static const char *advance(struct Instance *instance, const struct CommunicationStep *step) {
  struct Exact *exact = instance->solver_memory;
  struct Span *span = &instance->fmu_state->last_step;
  double sample = next_sample(instance, span->end);
  span->start = span->end;
  memcpy(exact->state, exact->next, lagrangian.state_count * sizeof(double));
  bool is_all = span->start == step->start && sample >= step->end;
  double end = fmin(sample, step->end), length = is_all ? step->length : end - span->start;
  bool is_whole = compute_next(instance, exact, length);
  double possible = is_whole ? length : longest_step(instance, exact, length);
  span->end = is_whole ? end : span->start + possible;
  if (!is_whole && (possible == 0.0 || !compute_next(instance, exact, possible))) {
    memcpy(exact->next, exact->state, lagrangian.state_count * sizeof(double));
    return "the motion grows without bound";
  }
  memcpy(instance->saved, exact->next_low, lagrangian.state_count * sizeof(double));
  instance->fmu_state->statistics[STATISTIC_STEPS]++;
  return is_whole ? NULL : "the motion grows without bound";
}

/* A state inside the step is not available: advance() computes only its end. */
static bool interpolate(struct Instance *instance, double time, double *state) {
  const struct Exact *exact = instance->solver_memory;
  const struct Span *span = &instance->fmu_state->last_step;
  if (time != span->start && time != span->end) return false;
  memcpy(state, time == span->end ? exact->next : exact->state, lagrangian.state_count * sizeof(double));
  return true;
}

const struct Solver solver_exact = {.name = "the matrix exponential",
                                    .remedy = "try a shorter step",
                                    .starts_anew = true,
                                    .saved_size = saved_size,
                                    .is_saved_valid = is_saved_valid,
                                    .create = create,
                                    .destroy = solver_free_memory,
                                    .restart = restart,
                                    .advance = advance,
                                    .interpolate = interpolate};
