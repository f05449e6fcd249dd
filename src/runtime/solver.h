/* What a solver offers fmi2DoStep. Each method is one file, and an FMU links the one that its system names. */
#ifndef SOLVER_H
#define SOLVER_H

#include "instance.h"

enum StepResult {
  STEP_DONE,
  STEP_PARTIAL, /* the state belongs to a time before the end, which *reached tells */
  STEP_FAILED   /* the state is as it was */
};

struct Solver {
  /* Bytes that the solver keeps in the situation, at instance->saved; NULL for none. */
  size_t (*saved_size)(void);
  /* The library behind the solver has an allocator of its own; canNotUseMemoryManagementFunctions is then true. */
  bool allocates_by_itself;
  /* Allocates instance->solver_memory. False after logging where that fails. */
  bool (*create)(struct Instance *instance);
  void (*destroy)(struct Instance *instance);
  /*
   * Integrates instance->state from situation->time over length > 0, and logs what goes wrong. Where
   * situation->changed or instance->solver_is_stale, the past of the solver no longer counts.
   */
  enum StepResult (*step)(struct Instance *instance, double length, double *reached);
};

extern const struct Solver solver_erk, solver_bdf, solver_exact, solver_taylor;

/*
 * d state / dt at a time and state that the solver chose, with the inputs of that time; counts the evaluation.
 * False where it does not exist.
 */
bool solver_derivatives(struct Instance *instance, double time, const double *state, double *derivative);

/* The point for the generated Jacobian at a time and state that the solver chose. */
struct Point solver_point(struct Instance *instance, double time, const double *state);

#endif
