/*
 * Linear systems, x' = A x + B u + c with inputs that are polynomials over the step, by the matrix exponential: with
 * z = (x, 1, u, u', u'', u''') the system is z' = Z z, and z(h) = exp(Z h) z(0).
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "log.h"
#include "solver.h"

/* What is kept of the last step: with the same step and parameters, its matrix serves again. */
struct Exact {
  size_t order;      /* 1 + INPUT_ORDER where the matrix takes input derivatives, else 1 */
  double step;       /* 0 for none */
  double *parameter; /* parameter_count */
  double *matrix;    /* exp(Z h), size x size by rows */
  double *term, *sum, *generator, *extended;
};

static size_t size_of(size_t order) {
  return lagrangian.state_count + 1 + order * lagrangian.input_count;
}

static void destroy(struct Instance *instance) {
  struct Exact *exact = instance->solver_memory;
  if (exact->parameter != NULL) instance->free(exact->parameter);
  instance->free(exact);
  instance->solver_memory = NULL;
}

static bool create(struct Instance *instance) {
  size_t size = size_of(1 + INPUT_ORDER), square = size * size;
  struct Exact *exact = instance->allocate(1, sizeof *exact);
  if (exact != NULL) {
    instance->solver_memory = exact;
    exact->parameter = instance->allocate(lagrangian.parameter_count + 4 * square + size, sizeof(double));
    if (exact->parameter != NULL) {
      exact->matrix = exact->parameter + lagrangian.parameter_count;
      exact->term = exact->matrix + square;
      exact->sum = exact->term + square;
      exact->generator = exact->sum + square;
      exact->extended = exact->generator + square;
      return true;
    }
    destroy(instance);
  }
  log_message(instance, fmi2Error, "allocateMemory returned no memory for the solver");
  return false;
}

/* result = a b for square matrices by rows */
static void multiply(size_t n, const double *a, const double *b, double *result) {
  memset(result, 0, n * n * sizeof *result);
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < n; k++) {
      double factor = a[i * n + k];
      if (factor == 0.0) continue;
      for (size_t j = 0; j < n; j++) result[i * n + j] += factor * b[k * n + j];
    }
}

/* Z h, its columns in the order x, 1, u, u', ... */
static void fill_generator(struct Instance *instance, struct Exact *exact, double step) {
  size_t states = lagrangian.state_count, inputs = lagrangian.input_count, n = size_of(exact->order);
  size_t columns = states + inputs + 1;
  double *linear = exact->term;
  memset(exact->generator, 0, n * n * sizeof(double));
  lagrangian.linear(instance->parameter, instance->prepared, linear);
  for (size_t i = 0; i < states; i++) {
    double *row = exact->generator + i * n;
    const double *source = linear + i * columns;
    for (size_t j = 0; j < states; j++) row[j] = step * source[j];
    row[states] = step * source[states + inputs];
    for (size_t j = 0; j < inputs; j++) row[states + 1 + j] = step * source[states + j];
  }
  for (size_t i = states + 1; i + inputs < n; i++) exact->generator[i * n + i + inputs] = step;
}

static double norm(size_t n, const double *a) {
  double largest = 0.0;
  for (size_t i = 0; i < n; i++) {
    double sum = 0.0;
    for (size_t j = 0; j < n; j++) sum += fabs(a[i * n + j]);
    if (!(sum <= largest)) largest = sum;
  }
  return largest;
}

/* matrix = exp(generator): Taylor's series of the generator halved to a norm below 1/2, then squared as often. */
static bool exponentiate(struct Exact *exact, size_t n) {
  double size = norm(n, exact->generator);
  int halvings = 0;
  if (!isfinite(size)) return false;
  if (size > 0.5) halvings = ilogb(size) + 2;
  for (size_t i = 0; i < n * n; i++) exact->generator[i] = ldexp(exact->generator[i], -halvings);
  memset(exact->matrix, 0, n * n * sizeof(double));
  for (size_t i = 0; i < n; i++) exact->matrix[i * n + i] = 1.0;
  memcpy(exact->term, exact->matrix, n * n * sizeof(double));
  for (int k = 1; norm(n, exact->term) > 0.01 * DBL_EPSILON; k++) {
    multiply(n, exact->term, exact->generator, exact->sum);
    for (size_t i = 0; i < n * n; i++) {
      exact->term[i] = exact->sum[i] / k;
      exact->matrix[i] += exact->term[i];
    }
  }
  for (int i = 0; i < halvings; i++) {
    multiply(n, exact->matrix, exact->matrix, exact->sum);
    memcpy(exact->matrix, exact->sum, n * n * sizeof(double));
  }
  return isfinite(norm(n, exact->matrix));
}

/* Brings the matrix up to date with step and parameters. */
static bool prepare_matrix(struct Instance *instance, struct Exact *exact, double step) {
  size_t bytes = lagrangian.parameter_count * sizeof(double);
  size_t order = instance->situation->input_derivatives_set ? 1 + INPUT_ORDER : 1;
  if (exact->step == step && exact->order == order && memcmp(exact->parameter, instance->parameter, bytes) == 0)
    return true;
  exact->order = order;
  fill_generator(instance, exact, step);
  exact->step = exponentiate(exact, size_of(order)) ? step : 0.0;
  memcpy(exact->parameter, instance->parameter, bytes);
  return exact->step != 0.0;
}

static enum StepResult step(struct Instance *instance, double length, double *reached) {
  struct Exact *exact = instance->solver_memory;
  size_t states = lagrangian.state_count, inputs = lagrangian.input_count;
  (void)reached;
  if (!prepare_matrix(instance, exact, length)) {
    log_message(instance, fmi2Error, "the motion over a step of %g grows beyond all numbers; try a shorter step",
                length);
    return STEP_FAILED;
  }
  size_t n = size_of(exact->order);
  memcpy(exact->extended, instance->state, states * sizeof(double));
  exact->extended[states] = 1.0;
  memcpy(exact->extended + states + 1, instance->input, inputs * sizeof(double));
  if (exact->order > 1)
    memcpy(exact->extended + states + 1 + inputs, instance->input_derivatives, INPUT_ORDER * inputs * sizeof(double));
  for (size_t i = 0; i < states; i++) {
    double sum = 0.0;
    for (size_t j = 0; j < n; j++) sum += exact->matrix[i * n + j] * exact->extended[j];
    exact->sum[i] = sum;
  }
  for (size_t i = 0; i < states; i++) {
    if (isfinite(exact->sum[i])) continue;
    log_message(instance, fmi2Error, "the motion grows beyond all numbers; try a shorter simulation");
    return STEP_FAILED;
  }
  memcpy(instance->state, exact->sum, states * sizeof(double));
  instance->situation->statistics[STATISTIC_STEPS]++;
  return STEP_DONE;
}

const struct Solver solver_exact = {.create = create, .destroy = destroy, .step = step};
