/* What a solver offers. Each method is one file of methods/, and an FMU links the one that its system names. */
#ifndef SOLVER_H
#define SOLVER_H

#include "instance/instance.h"

/* A communication step on its way. */
struct CommunicationStep {
  double start, end;
  double length; /* > 0; end - start but for rounding */
  long count;    /* steps that the solver has made in it */
};

/*
 * Everything that the core knows of a method. A solver makes steps of its own: situation->last_step spans the last one,
 * which may reach past the communication step, and whose states interpolate() knows. Meanwhile situation->time and
 * instance->state are those of the start of the communication step.
 */
struct Solver {
  const char *name;         /* in messages */
  const char *remedy;       /* what to do after the message that it stopped; NULL for the usual */
  const char *alternatives; /* other methods that may not stop, and where; NULL for none */
  const char *finer;        /* other methods, which err less between the ends of their steps; NULL for none */
  /* Every communication step does, so that it depends on nothing that the solver keeps. */
  bool starts_anew;
  /* Bytes that the solver keeps in the situation, at instance->saved; NULL for none. */
  size_t (*saved_size)(void);
  /*
   * Whether the solver could have kept these bytes, at any address, in a situation that begins like this one. NULL where
   * it keeps nothing.
   */
  bool (*could_save)(const struct Situation *situation, const void *saved);
  /*
   * Does a task in which the other functions but destroy() may be called. False where there was no memory: the task was
   * left halfway, and solver_memory is NULL. NULL for a solver that needs nothing around it.
   */
  bool (*run)(struct Instance *instance, void (*task)(void *argument), void *argument);
  /* Allocates instance->solver_memory. False after logging where that fails. */
  bool (*create)(struct Instance *instance);
  void (*destroy)(struct Instance *instance);
  /*
   * Begins at this state and the end of last_step, an empty span; the past no longer counts. False after logging where
   * that fails. NULL where there is nothing to do.
   */
  bool (*restart)(struct Instance *instance, const double *state, const struct CommunicationStep *step);
  /* Goes on after another situation was restored. NULL for a solver that must restart then. */
  void (*resume)(struct Instance *instance);
  /*
   * Makes one step from the end of last_step, which then spans it. NULL, or the reason why there is no step: the end of
   * last_step, which is then left or moved to where the solver came, is as far as the state can go.
   */
  const char *(*advance)(struct Instance *instance, const struct CommunicationStep *step);
  /* The state at a time in last_step. False where it is not known. */
  bool (*interpolate)(struct Instance *instance, double time, double *state);
  /* Of several methods the one that made the last step; NULL for a solver that is one. */
  const struct Solver *(*at_work)(const struct Instance *instance);
  /* The states at several times, a row each, to the same bits. NULL for a solver that does no better than one by one. */
  bool (*interpolate_at)(struct Instance *instance, const double *times, size_t count, double *states);
};

#endif
