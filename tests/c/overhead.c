/*
 * Measures the cost of the FMI layer: overhead STEPS. Compares fmi2DoStep with direct calls of the core for
 * communication steps of 0.001 s, and counts allocations. Linked with the parts of one FMU.
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "fmi2/fmi2_component.h"
#include "stepping/steps.h"

enum { REPEATS = 7 };
static const double step_size = 0.001;

static long allocations, steps;

/* The functions of the C library; SUNDIALS gets wrappers of them. */
void *__real_calloc(size_t count, size_t size);
void __real_free(void *block);

static void *count_allocation(size_t count, size_t size) {
  allocations++;
  return __real_calloc(count, size);
}

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int initialize(fmi2Component c) {
  return fmi2Reset(c) == fmi2OK && fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK &&
         fmi2EnterInitializationMode(c) == fmi2OK && fmi2ExitInitializationMode(c) == fmi2OK &&
         fmi2DoStep(c, 0.0, step_size, fmi2True) == fmi2OK;
}

static double time_of_steps(fmi2Component c) {
  double start = seconds();
  for (long i = 1; i <= steps; i++)
    if (fmi2DoStep(c, (double)i * step_size, step_size, fmi2True) != fmi2OK) exit(1);
  return seconds() - start;
}

static double time_of_core(fmi2Component c) {
  struct FmiComponent *component = c;
  double start = seconds();
  for (long i = 1; i <= steps; i++)
    if (communication_step(&component->instance, (double)i * step_size, step_size) != STATUS_DONE) exit(1);
  return seconds() - start;
}

int main(int count, char **words) {
  const fmi2CallbackFunctions callbacks = {NULL, count_allocation, __real_free, NULL, NULL};
  fmi2Component c =
      fmi2Instantiate("overhead", fmi2CoSimulation, lagrangian.guid, NULL, &callbacks, fmi2False, fmi2False);
  double best_step = 1e9, best_core = 1e9;
  steps = count == 2 ? strtol(words[1], NULL, 10) : 0;
  if (c == NULL || steps < 1) return 2;
  long during_steps = 0;
  for (int i = 0; i < REPEATS; i++) {
    if (!initialize(c)) return 1;
    long before = allocations;
    double step = time_of_steps(c);
    during_steps += allocations - before;
    if (!initialize(c)) return 1;
    double core = time_of_core(c);
    if (step < best_step) best_step = step;
    if (core < best_core) best_core = core;
  }
  double scale = 1e9 / (double)steps;
  printf("%s: fmi2DoStep %.1f ns, the core alone %.1f ns, the FMI layer %.1f ns, %ld allocations in %ld steps\n",
         lagrangian.name, best_step * scale, best_core * scale, (best_step - best_core) * scale, during_steps,
         REPEATS * steps);
  fmi2FreeInstance(c);
  return during_steps > 0;
}
