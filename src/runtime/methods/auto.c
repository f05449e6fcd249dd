/*
 * Taylor series and Radau IIA in turn: whichever gets further in the motion with its work. Progress and work are watched
 * over windows of a few steps, and work is counted in arithmetic operations, not in time, so that the same choices are
 * made on every machine and after a saved state. The series begin; where their coefficients promise that an implicit
 * method gets further, that is tried, and stays as long as it does.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/services.h"
#include "instance/snapshot.h"
#include "methods/radau.h"
#include "methods/stiffness.h"

enum AutoMethod { AUTO_TAYLOR, AUTO_RADAU, AUTO_METHODS };

extern const struct Solver solver_taylor, solver_radau;
static const struct Solver *const solvers[AUTO_METHODS] = {&solver_taylor, &solver_radau};

static const int window[AUTO_METHODS] = {6, 3}; /* steps of a window */
/* All in windows. */
enum {
  WARM_UP = 1,       /* of a trial, before it is judged */
  TRIAL_LIMIT = 8,   /* how long one goes on while its steps grow */
  LONGEST_WAIT = 16, /* of the series before their coefficients are looked at again */
  LONG_RUN = 256,    /* of the series, after which Radau IIA needs to promise half as much */
  SHORT_STAY = 8,
  LONG_STAY = 256 /* of Radau IIA where fast motions come again and again: the first, the longest */
};
/* How many times the work of a vain trial the series do before the next one: at first, at most. */
enum { SHORT_PATIENCE = 2, LONG_PATIENCE = 256 };
static const double LARGEST_WORK = 1e15; /* operations that no window or trial comes to: days of work */
static const double GROWTH = 1.25;       /* of progress from window to window that keeps a trial alive */
static const double FIRST_GROWTH = 8.0;  /* of the first step of Radau IIA over the last one of the series */

/* What the situation holds after what the method at work keeps. */
struct Choice {
  int64_t method;          /* enum AutoMethod: the one at work */
  int64_t steps, restarts; /* in the window; it restarts for changed inputs and the like */
  int64_t windows;         /* since the method was chosen */
  int64_t patience;        /* windows to wait before Radau IIA is tried */
  int64_t next_patience;   /* after a vain trial: how many times its work the series do first */
  int64_t stay;            /* windows that Radau IIA is given at least, more where it was left soon */
  int64_t is_trial;        /* Radau IIA was not yet found to get further */
  int64_t crosses;         /* the last step of the series did, over a point where a function has none */
  double begin, work;      /* of the window: its time, and the operations in it */
  double last_speed;       /* progress for work in the window before */
  double trial_work;
  double promised_step;             /* of Radau IIA, the first one */
  double rate;                      /* stiffness_rate() at the last step of a window of Radau IIA */
  double taylor_speed, taylor_rate; /* progress for work of the series when they were left, and the rate there */
};

struct Auto {
  struct Choice *choice;
  double *state; /* state_count: workspace */
  void *memory[AUTO_METHODS];
};

static size_t largest_saved_size(void) {
  size_t one = solver_taylor.saved_size(), other = solver_radau.saved_size();
  return one > other ? one : other;
}

static size_t auto_saved_size(void) {
  return largest_saved_size() + sizeof(struct Choice);
}

static bool are_possible_counts(const struct Choice *choice) {
  const int64_t counts[] = {choice->steps, choice->restarts,      choice->windows, choice->patience,
                            choice->stay,  choice->next_patience, choice->crosses, choice->is_trial};
  return snapshot_are_counts(counts, sizeof counts / sizeof *counts) && choice->steps <= window[choice->method] &&
         choice->next_patience <= 2 * LONG_PATIENCE && choice->stay <= 4 * LONG_STAY && choice->is_trial <= 1 &&
         choice->crosses <= 1;
}

/* Not NaN, of which no comparison holds. */
static bool is_up_to(double number, double largest) {
  return number >= 0.0 && number <= largest;
}

static bool are_possible_numbers(const struct Choice *choice) {
  return isfinite(choice->begin) && is_up_to(choice->work, LARGEST_WORK) &&
         is_up_to(choice->trial_work, LARGEST_WORK) && is_up_to(choice->promised_step, DBL_MAX) &&
         is_up_to(choice->last_speed, INFINITY) && is_up_to(choice->taylor_speed, INFINITY) &&
         is_up_to(choice->taylor_rate, INFINITY) && is_up_to(choice->rate, INFINITY);
}

static bool auto_could_save(const struct Situation *situation, const void *saved) {
  struct Choice choice;
  memcpy(&choice, (const char *)saved + largest_saved_size(), sizeof choice);
  return choice.method >= 0 && choice.method < AUTO_METHODS && are_possible_counts(&choice) &&
         are_possible_numbers(&choice) && solvers[choice.method]->could_save(situation, saved);
}

/* Each method finds its own memory in the instance while it works. */
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
  if (automatic == NULL) return solver_lacks_memory(instance);
  automatic->choice = (struct Choice *)(void *)((char *)instance->saved + largest_saved_size());
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

static void begin_window(struct Choice *choice, double time) {
  choice->steps = choice->restarts = 0;
  choice->begin = time;
  choice->work = 0.0;
}

static bool auto_restart(struct Instance *instance, const double *state, const struct CommunicationStep *step) {
  struct Auto *automatic = auto_enter(instance);
  struct Choice *choice = automatic->choice;
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

/* Operations of Radau IIA, counted like those of the series (taylor_rule.h), for so many evaluations of the equations, and so many Jacobians with their factors. */
static double work_of_radau(int stages, double evaluations, double jacobians) {
  const struct OperationCounts *count = &lagrangian.steps.operations;
  double s = (double)stages, states = (double)lagrangian.state_count;
  double systems = 2.0 + 4.0 * (s - 1.0); /* a real one, and complex ones of four times its operations */
  double evaluation = 250.0 + count->derivatives + s * (20.0 + 5.0 * states) + systems / s * count->solve;
  double factors = 20.0 * s + systems * count->factor;
  return evaluations * evaluation + jacobians * (600.0 + count->jacobian + factors + 3.0 * s * s * states);
}

/* Lets the other method begin at the end of the last step. False where the state or the memory is missing. */
static bool hand_over(struct Instance *instance, struct Auto *automatic, const struct CommunicationStep *step) {
  struct Choice *choice = automatic->choice;
  struct Situation *situation = instance->situation;
  double time = situation->last_step.end;
  if (!solvers[choice->method]->interpolate(instance, time, automatic->state)) return false;
  choice->method = choice->method == AUTO_TAYLOR ? AUTO_RADAU : AUTO_TAYLOR;
  choice->windows = 0;
  begin_window(choice, time);
  if (situation->statistics[STATISTIC_HANDOVERS]++ == 0)
    log_message(instance, STATUS_DONE,
                "time %.15g: the system is stiff here; the solver goes on with Radau IIA, and with "
                "Taylor series again where they get further (solverHandovers counts)",
                time);
  memset(instance->saved, 0, largest_saved_size());
  instance->solver_memory = automatic->memory[choice->method];
  situation->last_step = (struct Span){time, time};
  if (!solvers[choice->method]->restart(instance, automatic->state, step)) return false;
  if (choice->method == AUTO_RADAU) radau_try_first(instance, choice->promised_step);
  choice->promised_step = 0.0;
  return true;
}

/* Whether Radau IIA would get further than the series do; the less it must promise, the longer they have been at work. */
static bool series_are_slow(struct Instance *instance, struct Choice *choice, double progress) {
  enum { ITERATIONS = 4 };
  const struct Taylor *taylor = instance->solver_memory;
  if (choice->crosses || !(taylor->saved->reach > 0.0)) return false;
  int stages = radau_stage_count(instance);
  double step = taylor->saved->reach * stiffness_promise(taylor, stages + 1, radau_tolerance(instance));
  if (choice->restarts > 0) step = fmin(step, progress / (double)choice->restarts);
  choice->promised_step = fmin(step, FIRST_GROWTH * taylor->saved->reach);
  double windows = (double)choice->windows, hope = (1.2 + 3.0 / windows) / (1.0 + windows / LONG_RUN);
  return step * choice->work > hope * progress * work_of_radau(stages, ITERATIONS * stages, 1.0);
}

static bool judge_series(struct Instance *instance, struct Choice *choice, double progress) {
  if (choice->patience > 0) {
    choice->patience--;
    return false;
  }
  if (!series_are_slow(instance, choice, progress)) {
    choice->patience = choice->windows / 4 < LONGEST_WAIT ? choice->windows / 4 : LONGEST_WAIT;
    return false;
  }
  choice->taylor_speed = progress / choice->work;
  choice->taylor_rate = choice->last_speed = choice->trial_work = 0.0;
  choice->is_trial = 1;
  return true;
}

/* A trial goes on as long as steps grow or want to; one in vain is not soon made again. */
static bool judge_trial(const struct Instance *instance, struct Choice *choice, double speed, double other) {
  double window_of_series = window[AUTO_TAYLOR] * work_of_series((double)taylor_rule(instance).order);
  choice->trial_work += choice->work;
  double next = radau_next_step(instance) * window[AUTO_RADAU] / choice->work;
  bool grows = choice->windows < TRIAL_LIMIT && (speed > GROWTH * choice->last_speed || next > other);
  choice->last_speed = speed;
  if (speed > other) choice->is_trial = 0;
  if (speed > other || choice->windows <= WARM_UP || grows) return false;
  choice->patience = (int64_t)((double)choice->next_patience * choice->trial_work / window_of_series);
  choice->next_patience *= choice->next_patience < LONG_PATIENCE ? 2 : 1;
  return true;
}

/*
 * The series would be as fast as they were, but for the rates that have changed since. Where fast motions come again and
 * again, as after each change of an input, the methods do not change with each of them.
 */
static bool judge_radau(const struct Instance *instance, struct Choice *choice, double progress) {
  double speed = progress / choice->work, other = choice->taylor_speed;
  if (choice->taylor_rate == 0.0) choice->taylor_rate = choice->rate;
  other *= choice->rate > 0.0 ? choice->taylor_rate / choice->rate : INFINITY;
  if (choice->is_trial) return judge_trial(instance, choice, speed, other);
  choice->next_patience = SHORT_PATIENCE;
  if (choice->windows <= choice->stay || speed > 0.8 * other) return false;
  bool is_soon = choice->windows < 2 * choice->stay + SHORT_STAY;
  choice->stay = is_soon ? (choice->stay < LONG_STAY ? 2 * choice->stay + SHORT_STAY : choice->stay) : choice->stay / 2;
  return true;
}

/* Whether the other method is to go on from here. */
static bool judge(struct Instance *instance, struct Choice *choice) {
  double time = instance->situation->last_step.end;
  if (choice->next_patience == 0) choice->next_patience = SHORT_PATIENCE;
  if (choice->steps == 0) begin_window(choice, time);
  if (choice->steps < window[choice->method]) return false;
  choice->windows++;
  bool is_slow = choice->method == AUTO_TAYLOR ? judge_series(instance, choice, time - choice->begin)
                                               : judge_radau(instance, choice, time - choice->begin);
  begin_window(choice, time);
  return is_slow;
}

/* The work of the method at work between two states of the statistics. */
static double work_between(const struct Instance *instance, const struct Choice *choice, const int64_t *before) {
  const int64_t *after = instance->situation->statistics;
  if (choice->method == AUTO_TAYLOR)
    return work_of_series((double)((const struct Taylor *)instance->solver_memory)->saved->order);
  return work_of_radau(radau_stage_count(instance),
                       (double)(after[STATISTIC_DERIVATIVES] - before[STATISTIC_DERIVATIVES]),
                       (double)(after[STATISTIC_JACOBIANS] - before[STATISTIC_JACOBIANS]));
}

static const char *make_step(struct Instance *instance, struct Auto *automatic, const struct CommunicationStep *step) {
  struct Choice *choice = automatic->choice;
  int64_t before[STATISTIC_COUNT];
  memcpy(before, instance->situation->statistics, sizeof before);
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
  static const char no_handover[] = "the solver cannot begin there";
  const char *problem = NULL;
  if (judge(instance, automatic->choice) && !hand_over(instance, automatic, step)) problem = no_handover;
  if (problem == NULL) problem = make_step(instance, automatic, step);
  if (problem != NULL && hand_over(instance, automatic, step)) {
    automatic->choice->taylor_speed = 0.0; /* what failed is not tried again before the other one fails */
    const char *other_problem = make_step(instance, automatic, step);
    if (other_problem == NULL || automatic->choice->method == AUTO_RADAU) problem = other_problem;
  }
  auto_leave(instance, automatic);
  return problem;
}

const struct Solver solver_auto = {.name = "the solver",
                                   .saved_size = auto_saved_size,
                                   .could_save = auto_could_save,
                                   .create = auto_create,
                                   .destroy = auto_destroy,
                                   .restart = auto_restart,
                                   .resume = auto_resume,
                                   .advance = auto_advance,
                                   .at_work = auto_at_work,
                                   .interpolate = auto_interpolate,
                                   .interpolate_at = auto_interpolate_at};
