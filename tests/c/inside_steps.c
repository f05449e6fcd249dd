/*
 * Integrates a generated system, which is linked in, by the solver's own steps, and prints each: inside_steps END.
 * A line has start and end of the step. For a third of the step and for its end, it has a flag (1: the solver can
 * interpolate the state) and the first state variable.
 */
#include <stdio.h>
#include <stdlib.h>

#include "fmi/simulation.h"
#include "instance/solver.h"

static void write_message(void *receiver, enum Status status, const char *message) {
  (void)receiver;
  (void)status;
  fprintf(stderr, "%s\n", message);
}

struct Task {
  struct Instance *instance;
  double end;
  int status; /* exit status */
};

/* Steps to the end; called by the solver. */
static void go(void *argument) {
  struct Task *task = argument;
  struct Instance *instance = task->instance;
  const struct Solver *solver = lagrangian.solver;
  struct CommunicationStep step = {.end = task->end, .length = task->end};
  const struct Span *last = &instance->fmu_state->last_step;
  double *state = calloc(lagrangian.state_count, sizeof *state);
  task->status = 1;
  if (state == NULL || !solver->create(instance) ||
      (solver->restart != NULL && !solver->restart(instance, instance->state, &step)))
    return;
  for (; last->end < task->end; step.count++) {
    if (solver->advance(instance, &step) != NULL) return;
    const double times[] = {last->start + (last->end - last->start) / 3.0, last->end};
    printf("%.17g %.17g", last->start, last->end);
    for (int i = 0; i < 2; i++) {
      bool is_known = solver->interpolate(instance, times[i], state);
      printf(" %d %.17g", is_known, state[0]);
    }
    putchar('\n');
  }
  free(state);
  task->status = 0;
}

int main(int count, char **words) {
  const struct Solver *solver = lagrangian.solver;
  const struct Allocator memory = {calloc, free};
  const struct Log log = {.write = write_message, .wanted = 1u << STATUS_ERROR};
  const struct ExperimentSetup experiment = {.tolerance = 1e-9, .has_tolerance = true};
  double end = count == 2 ? strtod(words[1], NULL) : 0.0;
  struct Instance instance;
  if (!(end > 0.0) || !instance_create(&instance, KIND_CO_SIMULATION, &memory, &log)) return 2;
  if (simulation_set_up(&instance, &experiment) != STATUS_DONE || simulation_start(&instance) != STATUS_DONE) return 1;
  struct Task task = {&instance, end, 1};
  if (solver->run == NULL) go(&task);
  else if (!solver->run(&instance, go, &task)) return 1;
  instance_destroy(&instance);
  return task.status;
}
