#include "library.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <dlfcn.h>

bool library_load(const char *path, struct Library *library) {
  struct {
    const char *name;
    void *target;
  } functions[] = {
      {"fmi2Instantiate", &library->instantiate},
      {"fmi2SetupExperiment", &library->setup_experiment},
      {"fmi2EnterInitializationMode", &library->enter_initialization_mode},
      {"fmi2ExitInitializationMode", &library->exit_initialization_mode},
      {"fmi2SetReal", &library->set_real},
      {"fmi2GetReal", &library->get_real},
      {"fmi2GetInteger", &library->get_integer},
      {"fmi2DoStep", &library->do_step},
      {"fmi2Reset", &library->reset},
      {"fmi2FreeInstance", &library->free_instance},
  };
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (handle == NULL) fprintf(stderr, "icon: %s\n", dlerror());
  for (size_t i = 0; i < sizeof functions / sizeof *functions && handle != NULL; i++) {
    void *function = dlsym(handle, functions[i].name);
    memcpy(functions[i].target, &function, sizeof function);
  }
  return handle != NULL;
}

bool start(const struct Library *fmu, fmi2Component c) {
  return fmu->setup_experiment(c, fmi2True, 1e-5, 0.0, fmi2False, 0.0) == fmi2OK &&
         fmu->enter_initialization_mode(c) == fmi2OK && fmu->exit_initialization_mode(c) == fmi2OK;
}

static bool step_to(const struct Library *fmu, fmi2Component c, const struct Description *description, double from,
                    double to) {
  /* The work of a step grows as the states do, or as their square. */
  double limit = fmin(200000.0, fmax(300.0, 4e6 / (description->states * description->states)));
  fmi2Integer steps = 0;
  return fmu->do_step(c, from, to - from, fmi2True) == fmi2OK &&
         fmu->get_integer(c, &description->solver_steps, 1, &steps) == fmi2OK && steps <= limit;
}

/* The first step, in parts that double from a tiny one: the work for a part tells that for the next. */
static bool begin(const struct Library *fmu, fmi2Component c, const struct Description *description, double end) {
  enum { HALVINGS = 24 };
  double from = 0.0;
  for (int i = HALVINGS; i >= 0; i--) {
    double to = ldexp(end, -i);
    if (!step_to(fmu, c, description, from, to)) return false;
    from = to;
  }
  return true;
}

bool advance(const struct Library *fmu, fmi2Component c, const struct Description *description, int i, double step) {
  if (i == 1) return begin(fmu, c, description, step);
  return step_to(fmu, c, description, (i - 1) * step, i * step);
}
