/*
 * Radau IIA methods with 3, 5 and 7 stages, of orders 5, 9 and 13, for stiff systems x' = f(t, x) (E. Hairer, G.
 * Wanner: Solving Ordinary Differential Equations II, sections IV.5 and IV.8; Stiff differential equations solved by
 * Radau methods, J. Comput. Appl. Math. 111, 1999).
 *
 * A step of length h finds the collocation polynomial, whose stages z_i = x(t + c_i h) - x(t) solve z_i = h sum over j
 * of a_ij f(t + c_j h, x(t) + z_j). The methods are L-stable; c_s = 1, and the last stage is the result. The polynomial
 * also is the dense output.
 *
 * Simplified Newton iterations solve for the stages, with the Jacobian at the start of this or an earlier step. In the
 * eigenvectors of A^-1, z = V w, they need one real and (s - 1) / 2 complex linear systems of the system's size
 * (radau.h). They begin with the polynomial of the last step, and end by the estimated contraction (solve_stages()).
 *
 * The error estimate is that of an embedded formula of order s with the additional node 0. The filter (mu - J)^-1
 * keeps it bounded for stiff parts. The step follows from it by Gustafsson's predictive controller. The order
 * follows from the contraction, as in the paper of 1999 (choose_method()). A failed attempt shortens the step to
 * 0.9 of it or less; the loop ends after ATTEMPT_LIMIT attempts or at the resolution of time.
 *
 * A step costs (s + 1) / 2 factorizations per attempt and s evaluations per iteration. The Jacobian of an earlier step
 * is kept while the iterations contract well with it (choose_jacobian()). The snapshot holds all that determines a
 * step: its start, the stages, the Jacobian, and the numbers of the controllers.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/services.h"
#include "instance/snapshot.h"
#include "methods/first_terms.h"
#include "methods/radau.h"
#include "methods/radau_tables.h"

/* Fraction of the tolerance for one step: errors of many steps add up (tests/solvers/test_motion.py). */
static const double radau_safety = 0.05;

/* Shortest first step relative to the time: in a shorter one, rounding would outweigh the change. */
static const double shortest_first_step = 1e-12;

static const char no_solution[] = "the equations have no solution";

/* Newton iterations per step, attempts per step, and steps without failure before the order may rise. */
enum {
  ITERATION_LIMIT = 12,
  ATTEMPT_LIMIT = 60,
  STEPS_OF_CAUTION = 10,
  METHOD_COUNT = sizeof methods / sizeof *methods
};

/* The part of the snapshot; followed by the state at the start of the last step, its stages, and a Jacobian. */
struct RadauSaved {
  double step;        /* last step in s; 0 if there is none, and no polynomial */
  double next;        /* proposed by the controller, in s; 0 for none */
  double error;       /* of the last step, relative to the tolerance, at least 1e-2 */
  double contraction; /* rate of the Newton iterations in the last step */
  int64_t method;     /* index of the last step's method */
  int64_t next_method;
  int64_t steps;          /* since the last failure of the iterations, at most STEPS_OF_CAUTION */
  int64_t keeps_jacobian; /* 1 if the next step begins with the Jacobian of the snapshot */
};

/* Memory of the method. saved, start, stages and the systems' Jacobian are parts of the snapshot. */
struct Radau {
  struct RadauSaved *saved;
  double *start, *stages; /* in the snapshot: states, STAGE_LIMIT x states */
  struct RadauSystems systems;
  double *state, *scale, *first; /* states each: start of the step in progress, its scale of the error, f */
  double *trial;                 /* states: workspace */
  double *z, *rates;             /* STAGE_LIMIT x states each: stages of the step in progress, f there */
  struct Complex *w;             /* SYSTEM_LIMIT x states: the stages in eigenvectors */
  Series *series;                /* workspace of first_terms.h */
};

/* Returns how many numbers follow struct RadauSaved in the snapshot. */
static size_t saved_numbers(void) {
  return (1 + STAGE_LIMIT) * lagrangian.state_count + lagrangian.implicit.pattern.count;
}

static size_t radau_saved_size(void) {
  return sizeof(struct RadauSaved) + saved_numbers() * sizeof(double);
}

static bool radau_is_saved_valid(const struct FmuState *fmu_state, const void *saved) {
  struct RadauSaved first;
  memcpy(&first, saved, sizeof first);
  return first.method >= 0 && first.method < METHOD_COUNT && first.next_method >= 0 &&
         first.next_method < METHOD_COUNT && first.steps >= 0 && first.steps <= STEPS_OF_CAUTION && first.step >= 0.0 &&
         first.next >= 0.0 && first.error >= 0.0 && first.contraction >= 0.0 &&
         fmu_state->last_step.end == fmu_state->last_step.start + first.step && snapshot_is_finite(saved, 4) &&
         first.keeps_jacobian >= 0 && first.keeps_jacobian <= 1 &&
         snapshot_is_finite((const char *)saved + sizeof first, saved_numbers());
}

static size_t lay_out_radau(struct Radau *radau, void *block) {
  size_t states = lagrangian.state_count;
  struct Arena arena = {(uintptr_t)block};
  ARENA_TAKE(&arena, radau->w, SYSTEM_LIMIT * states);
  ARENA_NUMBERS(&arena, states, &radau->state, &radau->scale, &radau->first, &radau->trial);
  ARENA_NUMBERS(&arena, STAGE_LIMIT * states, &radau->z, &radau->rates);
  ARENA_TAKE(&arena, radau->series, first_terms_rows());
  radau_systems_take(&radau->systems, &arena);
  return arena.next - (uintptr_t)block;
}

static bool radau_create(struct Instance *instance) {
  struct Radau counted, *radau = instance->memory.allocate(1, sizeof *radau + lay_out_radau(&counted, NULL));
  if (radau == NULL) return solver_is_out_of_memory(instance);
  lay_out_radau(radau, radau + 1);
  radau->saved = instance->saved;
  radau->start = (double *)(radau->saved + 1);
  radau->stages = radau->start + lagrangian.state_count;
  radau->systems.values = radau->stages + STAGE_LIMIT * lagrangian.state_count;
  radau_systems_find_slots(&radau->systems);
  instance->solver_memory = radau;
  return true;
}

double radau_tolerance(const struct Instance *instance) {
  return fmax(radau_safety * instance->fmu_state->tolerance, 4 * DBL_EPSILON);
}

static int64_t method_for(double tolerance) {
  return tolerance >= 1e-4 ? 0 : tolerance >= 1e-7 ? 1 : 2;
}

static bool radau_restart(struct Instance *instance, const double *state, const struct CommunicationStep *step) {
  struct Radau *radau = instance->solver_memory;
  struct RadauSaved *saved = radau->saved;
  (void)step;
  memcpy(radau->start, state, lagrangian.state_count * sizeof(double));
  memset(radau->stages, 0, STAGE_LIMIT * lagrangian.state_count * sizeof(double));
  saved->step = saved->error = 0.0;
  saved->contraction = 1.0;
  saved->method = saved->next_method = method_for(instance->fmu_state->tolerance);
  saved->steps = STEPS_OF_CAUTION;
  return true;
}

static void radau_resume(struct Instance *instance) {
  (void)instance; /* the snapshot holds everything */
}

/* Computes the collocation polynomial minus the state at its start. share: elapsed fraction of the step. */
static void evaluate_polynomial(const struct RadauMethod *method, const double *stages, double share, double *change) {
  size_t states = lagrangian.state_count;
  for (size_t k = 0; k < states; k++) change[k] = 0.0;
  double before[STAGE_LIMIT], after = share; /* products of the distances from the nodes before and after i */
  before[0] = 1.0;
  for (int i = 1; i < method->stages; i++) before[i] = before[i - 1] * (share - method->node[i - 1]);
  for (int i = method->stages; i-- > 0;) {
    double weight = method->weight[i] * before[i] * after;
    after *= share - method->node[i];
    for (size_t k = 0; k < states; k++) change[k] += weight * stages[(size_t)i * states + k];
  }
}

static bool radau_interpolate(struct Instance *instance, double time, double *state) {
  const struct Radau *radau = instance->solver_memory;
  const struct RadauSaved *saved = radau->saved;
  const struct RadauMethod *method = &methods[saved->method];
  const struct Span *last = &instance->fmu_state->last_step;
  size_t states = lagrangian.state_count;
  const double *end = radau->stages + (size_t)(method->stages - 1) * states;
  if (saved->step == 0.0) memset(radau->trial, 0, states * sizeof(double));
  else if (time == last->end) memcpy(radau->trial, end, states * sizeof(double));
  else evaluate_polynomial(method, radau->stages, (time - last->start) / saved->step, radau->trial);
  for (size_t k = 0; k < states; k++) state[k] = radau->start[k] + radau->trial[k];
  return true;
}

static double norm(const struct Radau *radau, const double *vector) {
  size_t states = lagrangian.state_count;
  double sum = 0.0;
  for (size_t k = 0; k < states; k++) sum += vector[k] / radau->scale[k] * (vector[k] / radau->scale[k]);
  return sqrt(sum / (double)states);
}

/* Extrapolates the polynomial of the last step as starting values of the stages; zeros if there is none. */
static void predict(struct Radau *radau, const struct RadauMethod *method, double step) {
  const struct RadauSaved *saved = radau->saved;
  const struct RadauMethod *last = &methods[saved->method];
  size_t states = lagrangian.state_count;
  for (int i = 0; i < method->stages; i++) {
    double *z = radau->z + (size_t)i * states;
    memset(z, 0, states * sizeof *z);
    if (saved->step == 0.0) continue;
    evaluate_polynomial(last, radau->stages, 1.0 + method->node[i] * step / saved->step, z);
    const double *end = radau->stages + (size_t)(last->stages - 1) * states;
    for (size_t k = 0; k < states; k++) z[k] -= end[k];
  }
}

/* Sets the stages to those of Euler's method, as starting values. */
static void predict_along_tangent(struct Radau *radau, const struct RadauMethod *method, double step) {
  size_t states = lagrangian.state_count;
  for (int i = 0; i < method->stages; i++)
    for (size_t k = 0; k < states; k++) radau->z[(size_t)i * states + k] = method->node[i] * step * radau->first[k];
}

/* Returns row j of V^-1 times the stages of one state variable. */
static struct Complex to_eigenvector(const struct RadauMethod *method, int j, const double *stages) {
  size_t states = lagrangian.state_count;
  struct Complex sum = {0.0, 0.0};
  for (int i = 0; i < method->stages; i++) {
    double stage = stages[(size_t)i * states];
    sum.real += method->back_real[j][i] * stage;
    sum.imaginary += method->back_imaginary[j][i] * stage;
  }
  return sum;
}

/* Computes w = V^-1 z for the real eigenvalue and one of each conjugate pair. */
static void to_eigenvectors(const struct RadauMethod *method, const double *z, struct Complex *w) {
  size_t states = lagrangian.state_count;
  for (int j = 0; j <= method->stages / 2; j++) {
    for (size_t k = 0; k < states; k++) {
      w[(size_t)j * states + k] = to_eigenvector(method, j, z + k);
    }
  }
}

/* Computes z = V w; the other one of each conjugate pair adds the same real part. */
static void from_eigenvectors(const struct RadauMethod *method, const struct Complex *w, double *z) {
  size_t states = lagrangian.state_count;
  for (int i = 0; i < method->stages; i++) {
    for (size_t k = 0; k < states; k++) {
      double sum = method->vector_real[i][0] * w[k].real;
      for (int j = 1; j <= method->stages / 2; j++) {
        const struct Complex part = w[(size_t)j * states + k];
        sum += 2.0 * (method->vector_real[i][j] * part.real - method->vector_imaginary[i][j] * part.imaginary);
      }
      z[(size_t)i * states + k] = sum;
    }
  }
}

/* Evaluates f at the stages. False if it does not exist there. */
static bool evaluate_stages(struct Instance *instance, struct Radau *radau, const struct RadauMethod *method,
                            double time, double step) {
  size_t states = lagrangian.state_count;
  for (int i = 0; i < method->stages; i++) {
    for (size_t k = 0; k < states; k++) radau->trial[k] = radau->state[k] + radau->z[(size_t)i * states + k];
    if (!solver_derivatives(instance, time + method->node[i] * step, radau->trial, radau->rates + (size_t)i * states))
      return false;
  }
  return true;
}

/*
 * Sets the starting values of the stages, and evaluates f there. Where f does not exist at those that predict() gives,
 * as where a root of 0 begins, the tangent leads to others. False if f does not exist there either.
 */
static bool begin_stages(struct Instance *instance, struct Radau *radau, const struct RadauMethod *method, double time,
                         double step) {
  predict(radau, method, step);
  if (evaluate_stages(instance, radau, method, time, step)) return true;
  predict_along_tangent(radau, method, step);
  return evaluate_stages(instance, radau, method, time, step);
}

/* Makes one Newton iteration; returns the norm of the change of z. */
static double iterate(struct Radau *radau, const struct RadauMethod *method) {
  size_t states = lagrangian.state_count;
  struct RadauSystems *systems = &radau->systems;
  for (int j = 0; j <= method->stages / 2; j++) {
    struct Complex *w = radau->w + (size_t)j * states, mu = systems->mu[j];
    for (size_t k = 0; k < states; k++) {
      struct Complex rate = to_eigenvector(method, j, radau->rates + k);
      systems->right_side[k].real = rate.real - (mu.real * w[k].real - mu.imaginary * w[k].imaginary);
      systems->right_side[k].imaginary = rate.imaginary - (mu.real * w[k].imaginary + mu.imaginary * w[k].real);
    }
    radau_systems_solve(systems, j);
    for (size_t k = 0; k < states; k++) {
      w[k].real += systems->solution[k].real;
      w[k].imaginary += systems->solution[k].imaginary;
    }
  }
  memcpy(radau->rates, radau->z, (size_t)method->stages * states * sizeof(double));
  from_eigenvectors(method, radau->w, radau->z);
  double sum = 0.0;
  for (int i = 0; i < method->stages; i++) {
    for (size_t k = 0; k < states; k++)
      radau->trial[k] = radau->z[(size_t)i * states + k] - radau->rates[(size_t)i * states + k];
    double change = norm(radau, radau->trial);
    sum += change * change;
  }
  return sqrt(sum / method->stages);
}

/*
 * Solves for the stages. Returns the number of iterations, 0 if they do not converge.
 *
 * With the contraction theta, theta / (1 - theta) times the last change bounds the remaining error of the iteration. It
 * must be below a small fraction of the tolerance; the iterations stop early if the remaining ones cannot reach that.
 */
static int solve_stages(struct Instance *instance, struct Radau *radau, const struct RadauMethod *method, double time,
                        double step, double *contraction) {
  double relative = radau_tolerance(instance);
  double enough = fmax(10 * DBL_EPSILON / relative, fmin(0.01, sqrt(relative))), before = 0.0;
  double expected = pow(fmax(*contraction, DBL_EPSILON), 0.8);
  if (!begin_stages(instance, radau, method, time, step)) return 0;
  to_eigenvectors(method, radau->z, radau->w);
  *contraction = expected; /* one iteration gives no new estimate; the old one moves towards 1 */
  for (int iteration = 1; iteration <= ITERATION_LIMIT; iteration++) {
    if (iteration > 1 && !evaluate_stages(instance, radau, method, time, step)) return 0;
    double change = iterate(radau, method);
    if (!isfinite(change)) return 0;
    if (iteration > 1) {
      double theta = change / before;
      *contraction = iteration == 2 ? theta : sqrt(theta * *contraction);
      bool rounds = change <= 200 * DBL_EPSILON / relative; /* the iterates change only by rounding errors */
      if (*contraction >= 0.99 && !rounds) return 0;
      expected = rounds ? 0.0 : *contraction / (1.0 - *contraction);
      if (expected * change * pow(*contraction, ITERATION_LIMIT - 1 - iteration) > enough && !rounds) return 0;
    }
    before = change;
    if (expected * change <= enough || change == 0.0) return iteration;
  }
  return 0;
}

/* Leaves the error estimate (mu - J)^-1 (rate + sum of error weights * stages / step) in trial; returns its norm. */
static double estimate(struct Radau *radau, const struct RadauMethod *method, const double *rate, double step) {
  size_t states = lagrangian.state_count;
  for (size_t k = 0; k < states; k++) {
    double sum = 0.0;
    for (int i = 0; i < method->stages; i++) sum += method->error[i] * radau->z[(size_t)i * states + k];
    radau->systems.right_side[k] = (struct Complex){rate[k] + sum / step, 0.0};
  }
  radau_systems_solve(&radau->systems, 0);
  for (size_t k = 0; k < states; k++) radau->trial[k] = radau->systems.solution[k].real;
  return norm(radau, radau->trial);
}

/*
 * Returns the norm of the error estimate. At first steps and after rejections, a second filtering with f at the state
 * plus the estimate removes stiff components.
 */
static double estimate_error(struct Instance *instance, struct Radau *radau, const struct RadauMethod *method,
                             double time, double step, bool is_sudden) {
  double error = estimate(radau, method, radau->first, step);
  if (error < 1.0 || !is_sudden) return fmax(error, 1e-10);
  size_t states = lagrangian.state_count;
  for (size_t k = 0; k < states; k++) radau->trial[k] += radau->state[k];
  if (!solver_derivatives(instance, time, radau->trial, radau->rates)) return error;
  return fmax(estimate(radau, method, radau->rates, step), 1e-10);
}

/* Returns the factor of the step. Gustafsson's predictive controller also takes the trend of the last two errors. */
static double factor_of_step(const struct RadauSaved *saved, const struct RadauMethod *method, double step,
                             double error, int iterations) {
  double power = 1.0 / (method->stages + 1);
  double caution = 0.9 * (2.0 * ITERATION_LIMIT + 1.0) / (2.0 * ITERATION_LIMIT + iterations);
  double factor = caution * pow(error, -power);
  if (saved->step > 0.0 && saved->error > 0.0 && error < 1.0)
    factor = fmin(factor, factor * step / saved->step * pow(saved->error / error, power));
  return fmin(8.0, fmax(0.2, factor));
}

/* Returns a first step that moves the state by 1e-3 of its size, at most 1e-3 of the communication step. */
static double first_step(const struct Instance *instance, const struct Radau *radau, double length) {
  double rate = norm(radau, radau->first) * radau_tolerance(instance);
  return rate * length > 1.0 ? 1e-3 / rate : 1e-3 * length;
}

/*
 * Begins a step at the end of the last one: projects the state there, and evaluates its scale and f. Returns NULL, or
 * the reason for a failure.
 */
static const char *begin(struct Instance *instance, struct Radau *radau, double time) {
  double relative = radau_tolerance(instance);
  radau_interpolate(instance, time, radau->state);
  const char *problem = solver_project(instance, time, radau->state);
  if (problem != NULL) return problem;
  for (size_t k = 0; k < lagrangian.state_count; k++)
    radau->scale[k] = relative * (fabs(radau->state[k]) + lagrangian.steps.nominal[k]);
  return solver_derivatives(instance, time, radau->state, radau->first) ? NULL : no_solution;
}

/*
 * Returns the step to try in s. The first one is at most a communication step, and long enough to change the time.
 * Every step is bounded by the limit that separates events, and by the functions in the equations (first_terms.h).
 */
static double trial_step(struct Instance *instance, struct Radau *radau, double time,
                         const struct CommunicationStep *communication) {
  const struct RadauSaved *saved = radau->saved;
  double step = saved->next;
  if (saved->step == 0.0) {
    step = fmin(step > 0.0 ? step : first_step(instance, radau, communication->length), communication->length);
    step = fmax(step, shortest_first_step * fabs(time));
  }
  if (communication->step_limit > 0.0) step = fmin(step, communication->step_limit);
  double longest = fmin(lagrangian.steps.max_step, 2.0 * step);
  return fmin(step, first_terms_step(instance, radau->series, time, radau->state, longest));
}

static void accept(struct Instance *instance, struct Radau *radau, const struct RadauMethod *method, double time,
                   double step) {
  struct FmuState *fmu_state = instance->fmu_state;
  size_t states = lagrangian.state_count;
  memcpy(radau->start, radau->state, states * sizeof(double));
  memcpy(radau->stages, radau->z, (size_t)method->stages * states * sizeof(double));
  radau->saved->method = method - methods;
  radau->saved->step = step;
  fmu_state->last_step = (struct Span){time, time + step};
  fmu_state->statistics[STATISTIC_STEPS]++;
}

/*
 * Chooses the method of the next step. Slow Newton convergence or a failure lowers the order: the extrapolated starting
 * values are poor. Fast convergence over STEPS_OF_CAUTION steps raises it, up to the order for the tolerance.
 */
static void choose_method(const struct Instance *instance, struct RadauSaved *saved, bool failed) {
  saved->steps = failed ? 0 : saved->steps < STEPS_OF_CAUTION ? saved->steps + 1 : STEPS_OF_CAUTION;
  bool is_lowest = saved->next_method == 0,
       is_highest = saved->next_method == method_for(instance->fmu_state->tolerance);
  if (!is_lowest && (failed || saved->contraction > 0.8)) saved->next_method--;
  else if (!is_highest && saved->contraction < 0.002 && saved->steps == STEPS_OF_CAUTION) saved->next_method++;
}

/*
 * Returns how many evaluations cost as much as a Jacobian: one for each column by directional derivatives, or one for
 * each element of a row.
 */
static double evaluations_of_jacobian(void) {
  double states = (double)lagrangian.state_count;
  return lagrangian.implicit.jacobian != NULL ? (double)lagrangian.implicit.pattern.count / states : states;
}

/*
 * Decides whether the next step keeps the Jacobian. To reduce an error by `accuracy`, iterations with the contraction
 * theta take log(accuracy) / log(theta) times s evaluations. A new Jacobian is worth its cost if the iterations take
 * more than one, and a share of that cost.
 */
static void choose_jacobian(struct RadauSaved *saved, const struct RadauMethod *method) {
  const double accuracy = 1e-3, share = 0.25;
  double iterations = 1.0 + share * evaluations_of_jacobian() / method->stages;
  saved->keeps_jacobian = saved->contraction <= pow(accuracy, 1.0 / iterations);
}

/* Evaluates the Jacobian at the start of the step in progress. False if it does not exist. */
static bool renew_jacobian(struct Instance *instance, struct Radau *radau, double time) {
  radau->saved->keeps_jacobian = 0;
  return radau_systems_evaluate(instance, &radau->systems, time, radau->state);
}

static const char *radau_advance(struct Instance *instance, const struct CommunicationStep *communication) {
  struct Radau *radau = instance->solver_memory;
  struct RadauSaved *saved = radau->saved;
  double time = instance->fmu_state->last_step.end;
  const char *problem = begin(instance, radau, time);
  if (problem != NULL) return problem;
  if (!saved->keeps_jacobian && !renew_jacobian(instance, radau, time)) return no_solution;
  const struct RadauMethod *method = &methods[saved->next_method];
  bool failed = false;
  double step = trial_step(instance, radau, time, communication);
  for (int attempt = 0; attempt < ATTEMPT_LIMIT; attempt++) {
    if (solver_step_vanishes(time, step)) return solver_vanished_step;
    double contraction = saved->contraction, error = 1.0;
    int iterations = 0;
    if (radau_systems_factor(&radau->systems, method, step))
      iterations = solve_stages(instance, radau, method, time, step, &contraction);
    if (iterations > 0) error = estimate_error(instance, radau, method, time, step, saved->step == 0.0 || attempt > 0);
    double next = iterations > 0 ? step * factor_of_step(saved, method, step, error, iterations) : 0.3 * step;
    if (error < 1.0) {
      accept(instance, radau, method, time, step);
      saved->next = next;
      saved->error = fmax(error, 1e-2);
      saved->contraction = contraction;
      choose_method(instance, saved, failed);
      choose_jacobian(saved, method);
      return NULL;
    }
    bool may_be_old = saved->keeps_jacobian;
    if (may_be_old && !renew_jacobian(instance, radau, time)) return no_solution;
    if (may_be_old && iterations == 0) continue; /* the same step, with the Jacobian here */
    failed |= iterations == 0;
    step = fmin(next, 0.9 * step);
  }
  return "steps were rejected too often";
}

void radau_try_first(struct Instance *instance, double step) {
  struct Radau *radau = instance->solver_memory;
  radau->saved->next = step;
}

double radau_next_step(const struct Instance *instance) {
  const struct Radau *radau = instance->solver_memory;
  return radau->saved->next;
}

int radau_stage_count(const struct Instance *instance) {
  return methods[method_for(instance->fmu_state->tolerance)].stages;
}

const double *radau_jacobian(const struct Instance *instance) {
  const struct Radau *radau = instance->solver_memory;
  return radau->systems.values;
}

const struct Solver solver_radau = {.name = "Radau",
                                    .alternatives = "auto where rates are alike",
                                    .finer = "<solver method=\"taylor\"/>",
                                    .saved_size = radau_saved_size,
                                    .is_saved_valid = radau_is_saved_valid,
                                    .create = radau_create,
                                    .destroy = solver_free_memory,
                                    .restart = radau_restart,
                                    .resume = radau_resume,
                                    .advance = radau_advance,
                                    .interpolate = radau_interpolate};
