/*
 * Automatic choice between the Taylor method and Radau IIA (L. Petzold: Automatic selection of methods for solving
 * stiff and nonstiff systems of ordinary differential equations, SIAM J. Sci. Stat. Comput. 4, 1983, describes the
 * problem). The method with the higher
 *
 *   speed = simulated time / arithmetic operations
 *
 * makes the steps. Time and operations are summed over windows of a few steps. Work is counted, not timed, so all
 * machines and restored snapshots choose alike.
 *
 * From Taylor to Radau: the series' coefficients show whether fast modes limit the step, and predict Radau's step
 * (stiffness.c). If its speed would exceed that of the series by a margin, a trial of Radau begins. The trial lasts
 * while the steps grow, at most TRIAL_LIMIT windows. It succeeds once Radau is faster than the series were; otherwise
 * the series return. After each failed trial in a row, the wait for the next one doubles in units of the trial's work.
 * So failed trials cost a bounded share of the work.
 *
 * From Radau to Taylor: stability limits the step of the series to a multiple of 1 / (fastest rate). Their present
 * speed is estimated as their last speed, times the rate then over the rate now (stiffness_rate()). The series return
 * if Radau is slower than 0.8 of that, after a minimum stay. The stay doubles if Radau was left soon, which prevents
 * oscillation between the methods.
 *
 * If a method cannot make a step, the other one is tried at once. The decisions cost O(1) for each step, and the norms
 * of the Jacobian once a window of Radau.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/services.h"
#include "instance/snapshot.h"
#include "methods/radau.h"
#include "methods/stiffness.h"

/* Indices of the two methods. */
enum AutoMethod { AUTO_TAYLOR, AUTO_RADAU, AUTO_METHODS };

extern const struct Solver solver_taylor, solver_radau;
static const struct Solver *const solvers[AUTO_METHODS] = {&solver_taylor, &solver_radau};

static const int window[AUTO_METHODS] = {6, 3}; /* steps of a window */
/* Times in windows. */
enum {
  WARM_UP = 1,       /* of a trial, before it is judged */
  TRIAL_LIMIT = 8,   /* longest trial whose steps grow */
  LONGEST_WAIT = 16, /* of the series between two checks of their coefficients */
  LONG_RUN = 256,    /* of the series, after which half the predicted speed suffices for a trial */
  SHORT_STAY = 8,
  LONG_STAY = 256 /* minimum stay of Radau IIA if it was left soon: first, and limit of doubling */
};
/* Work of the series before the next trial, as a multiple of the failed trial's work: first, and limit of doubling. */
enum { FIRST_WAIT_FACTOR = 2, WAIT_FACTOR_LIMIT = 256 };
static const double LARGEST_WORK = 1e15; /* plausibility limit of restored counters: days of work */
static const double GROWTH = 1.25;       /* of speed from window to window that keeps a trial alive */
static const double FIRST_GROWTH = 8.0;  /* largest ratio of the first Radau step to the last Taylor step */

/* The part of the snapshot after that of the active method. */
struct AutoSaved {
  int64_t method;          /* enum AutoMethod: the active one */
  int64_t steps, restarts; /* in the window; inputs that change cause restarts */
  int64_t windows;         /* since the last handover */
  int64_t wait;            /* windows before the next check of the coefficients */
  int64_t wait_factor;     /* multiple of a failed trial's work that the series do before the next one */
  int64_t stay;            /* minimum stay of Radau IIA, in windows */
  int64_t is_trial;        /* 1 until Radau IIA has been faster than the series */
  int64_t crosses;         /* 1 if the last Taylor step crossed a point without a series */
  double begin, work;      /* of the window: its start in s, its operations */
  double last_speed;       /* motion in s per operation, in the window before */
  double trial_work;
  double predicted_step;            /* predicted first step of Radau IIA, in s */
  double rate;                      /* stiffness_rate() at the last step of a Radau window, in 1/s */
  double taylor_speed, taylor_rate; /* speed and rate of the series when they were left */
};

/* Memory of this method. choice is in the snapshot; memory holds the solver_memory of both methods. */
struct Auto {
  struct AutoSaved *choice;
  double *state; /* state_count: workspace */
  void *memory[AUTO_METHODS];
};

static size_t largest_saved_size(void) {
  size_t one = solver_taylor.saved_size(), other = solver_radau.saved_size();
  return one > other ? one : other;
}

static size_t auto_saved_size(void) {
  return largest_saved_size() + sizeof(struct AutoSaved);
}

static bool are_possible_counts(const struct AutoSaved *choice) {
  const int64_t counts[] = {choice->steps, choice->restarts,    choice->windows, choice->wait,
                            choice->stay,  choice->wait_factor, choice->crosses, choice->is_trial};
  return snapshot_are_counts(counts, sizeof counts / sizeof *counts) && choice->steps <= window[choice->method] &&
         choice->wait_factor <= 2 * WAIT_FACTOR_LIMIT && choice->stay <= 4 * LONG_STAY && choice->is_trial <= 1 &&
         choice->crosses <= 1;
}

/* True if 0 <= number <= largest; false for NaN. */
static bool is_up_to(double number, double largest) {
  return number >= 0.0 && number <= largest;
}

static bool are_possible_numbers(const struct AutoSaved *choice) {
  return isfinite(choice->begin) && is_up_to(choice->work, LARGEST_WORK) &&
         is_up_to(choice->trial_work, LARGEST_WORK) && is_up_to(choice->predicted_step, DBL_MAX) &&
         is_up_to(choice->last_speed, INFINITY) && is_up_to(choice->taylor_speed, INFINITY) &&
         is_up_to(choice->taylor_rate, INFINITY) && is_up_to(choice->rate, INFINITY);
}

static bool auto_is_saved_valid(const struct FmuState *fmu_state, const void *saved) {
  struct AutoSaved choice;
  memcpy(&choice, (const char *)saved + largest_saved_size(), sizeof choice);
  return choice.method >= 0 && choice.method < AUTO_METHODS && are_possible_counts(&choice) &&
         are_possible_numbers(&choice) && solvers[choice.method]->is_saved_valid(fmu_state, saved);
}

/* Gives the active method its own memory until auto_leave(). */
static struct Auto *auto_enter(struct Instance *instance) {
  struct Auto *automatic = instance->solver_memory;
  instance->solver_memory = automatic->memory[automatic->choice->method];
  return automatic;
}

static void auto_leave(struct Instance *instance, struct Auto *automatic) {
  instance->solver_memory = automatic;
}

static void auto_destroy(struct Instance *instance) {
  struct Auto *automatic = instance->solver_memory;
  for (int i = 0; i < AUTO_METHODS; i++) {
    instance->solver_memory = automatic->memory[i];
    if (automatic->memory[i] != NULL) solvers[i]->destroy(instance);
  }
  instance->solver_memory = automatic;
  solver_free_memory(instance);
}

static bool auto_create(struct Instance *instance) {
  struct Auto *automatic = instance->memory.allocate(1, sizeof *automatic + lagrangian.state_count * sizeof(double));
  if (automatic == NULL) return solver_is_out_of_memory(instance);
  automatic->choice = (struct AutoSaved *)(void *)((char *)instance->saved + largest_saved_size());
  automatic->state = (double *)(automatic + 1);
  bool is_complete = true;
  for (int i = 0; i < AUTO_METHODS && is_complete; i++) {
    instance->solver_memory = NULL;
    is_complete = solvers[i]->create(instance);
    automatic->memory[i] = instance->solver_memory;
  }
  auto_leave(instance, automatic);
  if (!is_complete) auto_destroy(instance);
  return is_complete;
}

static const struct Solver *auto_at_work(const struct Instance *instance) {
  const struct Auto *automatic = instance->solver_memory;
  return solvers[automatic != NULL ? automatic->choice->method : AUTO_TAYLOR];
}

static void begin_window(struct AutoSaved *choice, double time) {
  choice->steps = choice->restarts = 0;
  choice->begin = time;
  choice->work = 0.0;
}

static bool auto_restart(struct Instance *instance, const double *state, const struct CommunicationStep *step) {
  struct Auto *automatic = auto_enter(instance);
  struct AutoSaved *choice = automatic->choice;
  choice->restarts++;
  if (choice->begin > step->start) begin_window(choice, step->start);
  bool is_done = solvers[choice->method]->restart(instance, state, step);
  auto_leave(instance, automatic);
  return is_done;
}

static void auto_resume(struct Instance *instance) {
  struct Auto *automatic = auto_enter(instance);
  solvers[automatic->choice->method]->resume(instance);
  auto_leave(instance, automatic);
}

static bool auto_interpolate(struct Instance *instance, double time, double *state) {
  struct Auto *automatic = auto_enter(instance);
  bool is_known = solvers[automatic->choice->method]->interpolate(instance, time, state);
  auto_leave(instance, automatic);
  return is_known;
}

static bool auto_interpolate_at(struct Instance *instance, const double *times, size_t count, double *states) {
  struct Auto *automatic = auto_enter(instance);
  bool are_known = solver_interpolate(solvers[automatic->choice->method], instance, times, count, states);
  auto_leave(instance, automatic);
  return are_known;
}

/*
 * Returns the operations of a step of Radau IIA, counted as work_of_series() does, with its factorizations and these
 * numbers of evaluations and of Jacobians.
 */
static double work_of_radau(int stages, double evaluations, double jacobians) {
  const struct OperationCounts *count = &lagrangian.steps.operations;
  double s = (double)stages, states = (double)lagrangian.state_count;
  double systems = 2.0 + 4.0 * (s - 1.0); /* one real system; a complex one counts four times */
  double evaluation = 250.0 + count->derivatives + s * (20.0 + 5.0 * states) + systems / s * count->solve;
  double factors = 20.0 * s + systems * count->factor;
  return evaluations * evaluation + jacobians * (600.0 + count->jacobian) + factors + 3.0 * s * s * states;
}

/* Starts the other method at the end of the last step. False if the state is unknown or memory is missing. */
static bool hand_over(struct Instance *instance, struct Auto *automatic, const struct CommunicationStep *step) {
  struct AutoSaved *choice = automatic->choice;
  struct FmuState *fmu_state = instance->fmu_state;
  double time = fmu_state->last_step.end;
  if (!solvers[choice->method]->interpolate(instance, time, automatic->state)) return false;
  choice->method = choice->method == AUTO_TAYLOR ? AUTO_RADAU : AUTO_TAYLOR;
  choice->windows = 0;
  begin_window(choice, time);
  if (fmu_state->statistics[STATISTIC_HANDOVERS]++ == 0)
    log_message(instance, STATUS_DONE,
                "time %.15g: the system is stiff; the solver continues with Radau IIA, and returns to Taylor series "
                "where they are faster (solverHandovers counts)",
                time);
  memset(instance->saved, 0, largest_saved_size());
  instance->solver_memory = automatic->memory[choice->method];
  fmu_state->last_step = (struct Span){time, time};
  if (!solvers[choice->method]->restart(instance, automatic->state, step)) return false;
  if (choice->method == AUTO_RADAU) radau_try_first(instance, choice->predicted_step);
  choice->predicted_step = 0.0;
  return true;
}

/*
 * True if Radau IIA is predicted to be faster than the series. The required margin falls with the time for which the
 * series were used.
 */
static bool series_are_slow(struct Instance *instance, struct AutoSaved *choice, double progress) {
  enum { ITERATIONS = 4 };
  const struct Taylor *taylor = instance->solver_memory;
  if (choice->crosses || !(taylor->saved->interval > 0.0)) return false;
  int stages = radau_stage_count(instance);
  double step = taylor->saved->interval * predicted_stiffness(taylor, stages + 1, radau_tolerance(instance));
  if (choice->restarts > 0) step = fmin(step, progress / (double)choice->restarts);
  choice->predicted_step = fmin(step, FIRST_GROWTH * taylor->saved->interval);
  double windows = (double)choice->windows, hope = (1.2 + 3.0 / windows) / (1.0 + windows / LONG_RUN);
  return step * choice->work > hope * progress * work_of_radau(stages, ITERATIONS * stages, 1.0);
}

static bool judge_series(struct Instance *instance, struct AutoSaved *choice, double progress) {
  if (choice->wait > 0) {
    choice->wait--;
    return false;
  }
  if (!series_are_slow(instance, choice, progress)) {
    choice->wait = choice->windows / 4 < LONGEST_WAIT ? choice->windows / 4 : LONGEST_WAIT;
    return false;
  }
  choice->taylor_speed = progress / choice->work;
  choice->taylor_rate = choice->last_speed = choice->trial_work = 0.0;
  choice->is_trial = 1;
  return true;
}

/* True if the trial has failed: Radau IIA is slower, and its steps neither grow nor are about to. Sets the wait. */
static bool judge_trial(const struct Instance *instance, struct AutoSaved *choice, double speed, double other) {
  double window_of_series = window[AUTO_TAYLOR] * work_of_series((double)taylor_rule(instance).order);
  choice->trial_work += choice->work;
  double next = radau_next_step(instance) * window[AUTO_RADAU] / choice->work;
  bool grows = choice->windows < TRIAL_LIMIT && (speed > GROWTH * choice->last_speed || next > other);
  choice->last_speed = speed;
  if (speed > other) choice->is_trial = 0;
  if (speed > other || choice->windows <= WARM_UP || grows) return false;
  choice->wait = (int64_t)((double)choice->wait_factor * choice->trial_work / window_of_series);
  choice->wait_factor *= choice->wait_factor < WAIT_FACTOR_LIMIT ? 2 : 1;
  return true;
}

/* True if the series are to return: see the top of this file. */
static bool judge_radau(const struct Instance *instance, struct AutoSaved *choice, double progress) {
  double speed = progress / choice->work, other = choice->taylor_speed;
  if (choice->taylor_rate == 0.0) choice->taylor_rate = choice->rate;
  other *= choice->rate > 0.0 ? choice->taylor_rate / choice->rate : INFINITY;
  if (choice->is_trial) return judge_trial(instance, choice, speed, other);
  choice->wait_factor = FIRST_WAIT_FACTOR;
  if (choice->windows <= choice->stay || speed > 0.8 * other) return false;
  bool is_soon = choice->windows < 2 * choice->stay + SHORT_STAY;
  choice->stay = is_soon ? (choice->stay < LONG_STAY ? 2 * choice->stay + SHORT_STAY : choice->stay) : choice->stay / 2;
  return true;
}

/* True if the other method is to take over at the end of the last step. */
static bool judge(struct Instance *instance, struct AutoSaved *choice) {
  double time = instance->fmu_state->last_step.end;
  if (choice->wait_factor == 0) choice->wait_factor = FIRST_WAIT_FACTOR;
  if (choice->steps == 0) begin_window(choice, time);
  if (choice->steps < window[choice->method]) return false;
  choice->windows++;
  bool is_slow = choice->method == AUTO_TAYLOR ? judge_series(instance, choice, time - choice->begin)
                                               : judge_radau(instance, choice, time - choice->begin);
  begin_window(choice, time);
  return is_slow;
}

/* Returns the work of the last step, from the statistics before it and now. */
static double work_between(const struct Instance *instance, const struct AutoSaved *choice, const int64_t *before) {
  const int64_t *after = instance->fmu_state->statistics;
  if (choice->method == AUTO_TAYLOR)
    return work_of_series((double)((const struct Taylor *)instance->solver_memory)->saved->order);
  return work_of_radau(radau_stage_count(instance),
                       (double)(after[STATISTIC_DERIVATIVES] - before[STATISTIC_DERIVATIVES]),
                       (double)(after[STATISTIC_JACOBIANS] - before[STATISTIC_JACOBIANS]));
}

static const char *make_step(struct Instance *instance, struct Auto *automatic, const struct CommunicationStep *step) {
  struct AutoSaved *choice = automatic->choice;
  int64_t before[STATISTIC_COUNT];
  memcpy(before, instance->fmu_state->statistics, sizeof before);
  const char *problem = solvers[choice->method]->advance(instance, step);
  choice->work += work_between(instance, choice, before);
  choice->steps++;
  if (choice->method == AUTO_TAYLOR) choice->crosses = ((const struct Taylor *)instance->solver_memory)->crosses;
  else if (choice->steps >= window[AUTO_RADAU])
    choice->rate = stiffness_rate(radau_jacobian(instance), automatic->state);
  return problem;
}

static const char *auto_advance(struct Instance *instance, const struct CommunicationStep *step) {
  struct Auto *automatic = auto_enter(instance);
  static const char no_handover[] = "the solver cannot restart at this time";
  const char *problem = NULL;
  if (judge(instance, automatic->choice) && !hand_over(instance, automatic, step)) problem = no_handover;
  if (problem == NULL) problem = make_step(instance, automatic, step);
  if (problem != NULL && hand_over(instance, automatic, step)) {
    automatic->choice->taylor_speed = 0.0; /* if the series failed, Radau IIA stays until it fails */
    const char *other_problem = make_step(instance, automatic, step);
    if (other_problem == NULL || automatic->choice->method == AUTO_RADAU) problem = other_problem;
  }
  auto_leave(instance, automatic);
  return problem;
}

const struct Solver solver_auto = {.name = "the solver",
                                   .saved_size = auto_saved_size,
                                   .is_saved_valid = auto_is_saved_valid,
                                   .create = auto_create,
                                   .destroy = auto_destroy,
                                   .restart = auto_restart,
                                   .resume = auto_resume,
                                   .advance = auto_advance,
                                   .at_work = auto_at_work,
                                   .interpolate = auto_interpolate,
                                   .interpolate_at = auto_interpolate_at};
