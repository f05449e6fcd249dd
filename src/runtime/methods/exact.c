/*
 * Linear systems, x' = A x + B u + c with inputs that are polynomials over the step, by the matrix exponential: with
 * z = (x, 1, u, u', u'', u''') the system is z' = Z z, and z(h) = exp(Z h) z(0).
 *
 * Two things keep the error of many steps near the rounding of the phase. A step adds the change of the state,
 * (exp(Z h) - I) z, whose rounding is that of a small number where the step is short. And what rounding takes from the
 * state is carried along in the saved situation (Kahan's compensated summation).
 */
#include <math.h>
#include <string.h>

#include "evaluation/inputs.h"
#include "evaluation/services.h"
#include "instance/snapshot.h"
#include "instance/time_laws.h"

/* What is kept of the last step: with the same step and parameters, its matrix serves again. */
struct Exact {
  size_t order;      /* 1 + INPUT_ORDER where the matrix takes input derivatives, else 1 */
  double step;       /* 0 for none */
  double *parameter; /* parameter_count */
  /* exp(Z h) = diag(identity) + matrix. The first state_count rows of both, size columns. */
  double *identity, *matrix;
  double *extended, *linear;
  double *state;           /* at the start of the step */
  double *next, *next_low; /* the state at the end of the step, and what rounding left of it */
  /* Workspace for the exponential, size x size by rows, and size powers of two. */
  long double *generator, *term, *product, *sum;
  int *exponent;
};

static size_t extended_size(size_t order) {
  return lagrangian.state_count + 1 + order * lagrangian.input_count;
}

static size_t saved_size(void) {
  return lagrangian.state_count * sizeof(double); /* what rounding left of the state */
}

static bool could_save(const struct Situation *situation, const void *saved) {
  (void)situation;
  return snapshot_is_finite(saved, lagrangian.state_count);
}

static void destroy(struct Instance *instance) {
  struct Exact *exact = instance->solver_memory;
  if (exact->generator != NULL) instance->memory.free(exact->generator);
  solver_free_memory(instance);
}

/* Divides one block of memory among the arrays. */
static void divide_block(struct Exact *exact, size_t size) {
  size_t states = lagrangian.state_count, square = size * size;
  exact->term = exact->generator + square;
  exact->product = exact->term + square;
  exact->sum = exact->product + square;
  exact->parameter = (double *)(exact->sum + square);
  exact->identity = exact->parameter + lagrangian.parameter_count;
  exact->matrix = exact->identity + states;
  exact->extended = exact->matrix + states * size;
  exact->next = exact->extended + size;
  exact->next_low = exact->next + states;
  exact->state = exact->next_low + states;
  exact->linear = exact->state + states;
  exact->exponent = (int *)(exact->linear + states * (states + lagrangian.input_count + 1));
}

static bool create(struct Instance *instance) {
  size_t states = lagrangian.state_count, size = extended_size(1 + INPUT_ORDER);
  size_t doubles = lagrangian.parameter_count + size + states * (size + states + lagrangian.input_count + 5);
  struct Exact *exact = instance->memory.allocate(1, sizeof *exact);
  if (exact != NULL) {
    instance->solver_memory = exact;
    exact->generator = instance->memory.allocate(1, 4 * size * size * sizeof(long double) + doubles * sizeof(double) +
                                                        size * sizeof(int));
    if (exact->generator != NULL) {
      divide_block(exact, size);
      return true;
    }
    destroy(instance);
  }
  return solver_lacks_memory(instance);
}

/* result = a b for square matrices by rows; zeros of a count as such, whatever they meet. */
static void multiply(size_t n, const long double *a, const long double *b, long double *result) {
  for (size_t i = 0; i < n * n; i++) result[i] = 0.0L;
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < n; k++) {
      long double factor = a[i * n + k];
      if (factor == 0.0L) continue;
      for (size_t j = 0; j < n; j++) result[i * n + j] += factor * b[k * n + j];
    }
}

/* Z h, its columns in the order x, 1, u, u', ... */
static void fill_generator(struct Instance *instance, struct Exact *exact, double step) {
  size_t states = lagrangian.state_count, inputs = lagrangian.input_count, n = extended_size(exact->order);
  size_t columns = states + inputs + 1;
  lagrangian.linear(instance->parameter, instance->prepared, exact->linear);
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

/* The power of two by which variable i is to be multiplied, so that its row and column become about equally large. */
static int balancing_exponent(size_t n, const long double *a, size_t i) {
  long double row = 0.0L, column = 0.0L;
  for (size_t j = 0; j < n; j++) {
    if (j == i) continue;
    row += fabsl(a[i * n + j]);
    column += fabsl(a[j * n + i]);
  }
  if (row == 0.0L && column == 0.0L) return 0;
  /* A constant, or a variable that nothing depends on, can be as small or as large as one likes. */
  if (row == 0.0L) return ilogbl(column) > 0 ? -ilogbl(column) : 0;
  if (column == 0.0L) return ilogbl(row) > 0 ? ilogbl(row) : 0;
  return (ilogbl(row) - ilogbl(column)) / 2;
}

/*
 * Replaces a by D^-1 a D with D = diag(2^exponent), which is smaller: few halvings then serve the exponential. (E. E.
 * Osborne: On pre-conditioning of matrices, 1960.) A few sweeps do; none of them rounds.
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

/* sum = exp(generator) - I by Taylor's series, for a norm below 1; it ends where no element changes. */
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
 * With E = diag(identity) + sum, the elements of identity being 0 or 1, sum becomes E^2 - diag(identity). As long as E
 * is near the identity, low digits of sum would be lost in it; where a variable decays, it is the other way round.
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

/* Makes the norm of the generator smaller than 1/2; returns by how many halvings, or -1 where it is not finite. */
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

/* identity and matrix of exp(generator). */
static bool exponentiate(struct Exact *exact, size_t n) {
  size_t states = lagrangian.state_count;
  int halvings = reduce(exact, n);
  if (halvings < 0) return false;
  sum_exponential(exact, n);
  double *identity = exact->extended; /* of all variables */
  for (size_t i = 0; i < n; i++) identity[i] = 1.0;
  for (int i = 0; i < halvings; i++) square(exact, n, identity);
  memcpy(exact->identity, identity, states * sizeof *identity);
  double total = 0.0;
  for (size_t i = 0; i < states; i++)
    for (size_t j = 0; j < n; j++) {
      double *element = &exact->matrix[i * n + j];
      *element = (double)ldexpl(exact->sum[i * n + j], exact->exponent[i] - exact->exponent[j]);
      total += *element - *element; /* NaN where one is not finite */
    }
  return total == 0.0;
}

/* Brings the matrix up to date with step and parameters. */
static bool prepare_matrix(struct Instance *instance, struct Exact *exact, double step) {
  size_t bytes = lagrangian.parameter_count * sizeof(double);
  size_t order = instance->situation->input_derivatives_set ? 1 + INPUT_ORDER : 1;
  if (exact->step == step && exact->order == order && memcmp(exact->parameter, instance->parameter, bytes) == 0)
    return true;
  exact->order = order;
  fill_generator(instance, exact, step);
  exact->step = exponentiate(exact, extended_size(order)) ? step : 0.0;
  memcpy(exact->parameter, instance->parameter, bytes);
  return exact->step != 0.0;
}

/* The inputs and their derivatives of orders below count at a time, by orders. */
static void fill_inputs(const struct Instance *instance, double time, size_t count, double *values) {
  double coefficient[INPUT_ORDER + 1];
  static const double factorial[INPUT_ORDER + 1] = {1.0, 1.0, 2.0, 6.0};
  for (size_t i = 0; i < lagrangian.input_count; i++) {
    expand_input(instance, i, time, coefficient);
    for (size_t order = 0; order < count; order++)
      values[order * lagrangian.input_count + i] = factorial[order] * coefficient[order];
  }
}

/*
 * Computes next = exp(Z h) extended from the state, and what rounding takes from that sum. False where it is not finite.
 */
static bool compute_next(struct Instance *instance, struct Exact *exact, double step) {
  size_t states = lagrangian.state_count;
  if (!prepare_matrix(instance, exact, step)) return false;
  size_t n = extended_size(exact->order);
  const double *low = instance->saved;
  memcpy(exact->extended, exact->state, states * sizeof(double));
  exact->extended[states] = 1.0;
  fill_inputs(instance, instance->situation->last_step.start, exact->order, exact->extended + states + 1);
  double total = 0.0;
  const double *element = exact->matrix, *extended = exact->extended;
  for (size_t i = 0; i < states; i++) {
    double before = exact->identity[i] * extended[i], term = exact->identity[i] * low[i];
    for (size_t j = 0; j < n; j++) term += *element++ * extended[j];
    double sum = before + term, part = sum - before;
    exact->next_low[i] = (before - (sum - part)) + (term - part);
    exact->next[i] = sum;
    total += sum - sum; /* NaN where one is not finite */
  }
  return total == 0.0;
}

/* The longest step, to a millionth of this one, whose end is finite. */
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

/* To the end of the communication step or the next sample, or as far as the state is finite. */
static const char *advance(struct Instance *instance, const struct CommunicationStep *step) {
  struct Exact *exact = instance->solver_memory;
  struct Span *span = &instance->situation->last_step;
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
  instance->situation->statistics[STATISTIC_STEPS]++;
  return is_whole ? NULL : "the motion grows without bound";
}

/* A step has no states inside: its end is all that advance() computes. */
static bool interpolate(struct Instance *instance, double time, double *state) {
  const struct Exact *exact = instance->solver_memory;
  const struct Span *span = &instance->situation->last_step;
  if (time != span->start && time != span->end) return false;
  memcpy(state, time == span->end ? exact->next : exact->state, lagrangian.state_count * sizeof(double));
  return true;
}

const struct Solver solver_exact = {.name = "the matrix exponential",
                                    .remedy = "try a shorter step",
                                    .starts_anew = true,
                                    .saved_size = saved_size,
                                    .could_save = could_save,
                                    .create = create,
                                    .destroy = destroy,
                                    .restart = restart,
                                    .advance = advance,
                                    .interpolate = interpolate};
