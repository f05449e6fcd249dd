/* The functions of an FMU that a run needs. */
#ifndef LIBRARY_H
#define LIBRARY_H

#include <stdbool.h>

#include "description.h"
#include "fmi2.h"

struct Library {
  __typeof__(fmi2Instantiate) *instantiate;
  __typeof__(fmi2SetupExperiment) *setup_experiment;
  __typeof__(fmi2EnterInitializationMode) *enter_initialization_mode;
  __typeof__(fmi2ExitInitializationMode) *exit_initialization_mode;
  __typeof__(fmi2SetReal) *set_real;
  __typeof__(fmi2GetReal) *get_real;
  __typeof__(fmi2GetInteger) *get_integer;
  __typeof__(fmi2DoStep) *do_step;
  __typeof__(fmi2Reset) *reset;
  __typeof__(fmi2FreeInstance) *free_instance;
};

/* False after a message where the library cannot be loaded. */
bool library_load(const char *path, struct Library *library);

/* Brings a new or reset instance to its start. False where the system cannot start at its start values. */
bool start(const struct Library *fmu, fmi2Component c);

/*
 * Goes from (i - 1) step to i step, for i = 1, 2, ... False where the FMU fails, or where the solver has taken too many
 * steps, as for a stiff system.
 */
bool advance(const struct Library *fmu, fmi2Component c, const struct Description *description, int i, double step);

#endif
