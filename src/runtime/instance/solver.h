/* Interface of the integration methods. Each is a file of methods/; an FMU links the one that its system names. */
#pragma once

#include "instance/instance.h"

/* A communication step in progress. */
struct CommunicationStep {
  double start, end;
  double length;     /* in s, > 0; equals end - start to rounding */
  double step_limit; /* longest step of the solver in s, to separate events; 0 for none */
  long count;        /* solver steps made in it */
};

/*
 * The functions of a method. A solver makes steps of its own. fmu_state->last_step spans the last one, and
 * interpolate() gives the states inside it. It may reach past the communication step. During a communication step,
 * fmu_state->time and instance->state stay those of its start.
 */
struct Solver {
  const char *name;         /* in messages */
  const char *remedy;       /* advice after the message that it stopped; NULL for the usual one */
  const char *alternatives; /* other methods that may not stop, and when; NULL for none */
  const char *finer;        /* methods with smaller errors inside a step, for advice; NULL for none */
  /* The solver restarts at every communication step, so that results do not depend on its memory. */
  bool starts_anew;
  /* Returns the bytes of the solver's part of the snapshot, at instance->saved; NULL for none. */
  size_t (*saved_size)(void);
  /* True if the solver could have saved this part, at any alignment, with these fixed fields of the snapshot. */
  bool (*is_saved_valid)(const struct FmuState *fmu_state, const void *saved);
  /*
   * Runs a task that may call the other functions, but not destroy(). False if memory was missing: the task was left
   * halfway, and solver_memory is NULL. NULL for solvers that need no such context.
   */
  bool (*run)(struct Instance *instance, void (*task)(void *argument), void *argument);
  /* Allocates instance->solver_memory. False, after logging, if that fails. */
  bool (*create)(struct Instance *instance);
  void (*destroy)(struct Instance *instance);
  /*
   * Starts from this state at the end of last_step, an empty span, and drops the past. False, after logging, if that
   * fails. NULL if there is nothing to do.
   */
  bool (*restart)(struct Instance *instance, const double *state, const struct CommunicationStep *step);
  /* Continues after another snapshot was restored. NULL for solvers that must restart then. */
  void (*resume)(struct Instance *instance);
  /*
   * Makes one step from the end of last_step, which then spans it. Returns NULL, or the reason for a failure. After a
   * failure, the end of last_step is the last time with a state.
   */
  const char *(*advance)(struct Instance *instance, const struct CommunicationStep *step);
  /* Computes the state at a time in last_step. False if it is not available. */
  bool (*interpolate)(struct Instance *instance, double time, double *state);
  /* Returns the method that made the last step, of a solver with several; NULL for others. */
  const struct Solver *(*at_work)(const struct Instance *instance);
  /* Computes the states at several times, one row each, to the same bits as interpolate(). NULL if it is no faster. */
  bool (*interpolate_at)(struct Instance *instance, const double *times, size_t count, double *states);
};
