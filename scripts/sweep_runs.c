/* The runs of a sweep: the functions of an FMU that is there already, called for one set of values after another. */
#include <time.h>

#include "fmi2.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

struct Functions {
  fmi2Status (*reset)(fmi2Component component);
  fmi2Status (*setup)(fmi2Component component, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                      fmi2Boolean has_stop, fmi2Real stop);
  fmi2Status (*set)(fmi2Component component, const fmi2ValueReference references[], size_t count,
                    const fmi2Real values[]);
  fmi2Status (*enter)(fmi2Component component);
  fmi2Status (*exit)(fmi2Component component);
  fmi2Status (*step)(fmi2Component component, fmi2Real time, fmi2Real size, fmi2Boolean is_final);
  fmi2Status (*get)(fmi2Component component, const fmi2ValueReference references[], size_t count, fmi2Real values[]);
};

struct Variables {
  size_t count;
  const fmi2ValueReference *references;
};

/* Of arrays over runs, each has a row for every one. */
struct Sweep {
  struct Variables varied, watched, ends;
  const double *values;         /* of what varies: runs x varied */
  double tolerance, stop;       /* tolerance: 0 for the FMU's own */
  size_t steps;                 /* communication steps a run */
  double *before, *after;       /* of what is watched: runs x watched, behind the initialization and at the end */
  double *end_values, *seconds; /* runs x ends; runs */
};

static double now(void) {
  struct timespec time;
  timespec_get(&time, TIME_UTC);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* Until a function fails: its name then, and NULL where all went well. */
static const char *run(const struct Functions *f, fmi2Component component, const struct Sweep *sweep, size_t k) {
  const struct Variables *varied = &sweep->varied, *watched = &sweep->watched, *ends = &sweep->ends;
  if (f->reset(component) > fmi2Warning) return "fmi2Reset";
  if (f->setup(component, sweep->tolerance > 0, sweep->tolerance, 0, fmi2False, 0) > fmi2Warning)
    return "fmi2SetupExperiment";
  if (f->set(component, varied->references, varied->count, sweep->values + k * varied->count) > fmi2Warning)
    return "fmi2SetReal";
  if (f->enter(component) > fmi2Warning) return "fmi2EnterInitializationMode";
  if (f->exit(component) > fmi2Warning) return "fmi2ExitInitializationMode";
  if (f->get(component, watched->references, watched->count, sweep->before + k * watched->count) > fmi2Warning)
    return "fmi2GetReal";
  for (size_t i = 0; i < sweep->steps; i++) {
    double time = sweep->stop * (double)i / (double)sweep->steps,
           next = sweep->stop * (double)(i + 1) / (double)sweep->steps;
    if (f->step(component, time, next - time, fmi2True) > fmi2Warning) return "fmi2DoStep";
  }
  if (f->get(component, ends->references, ends->count, sweep->end_values + k * ends->count) > fmi2Warning ||
      f->get(component, watched->references, watched->count, sweep->after + k * watched->count) > fmi2Warning)
    return "fmi2GetReal";
  return NULL;
}

/*
 * Runs first, first + 1, ... up to count, which is returned; or the run that fails, and the name of the function that
 * did. Its times are those of the machine's clock.
 */
EXPORT size_t sweep_runs(const struct Functions *functions, fmi2Component component, const struct Sweep *sweep,
                         size_t first, size_t count, const char **failed) {
  *failed = NULL;
  for (size_t k = first; k < count; k++) {
    double begin = now();
    *failed = run(functions, component, sweep, k);
    sweep->seconds[k] = now() - begin;
    if (*failed != NULL) return k;
  }
  return count;
}

/* How many lanes of src/ensemble the processor computes at once. */
EXPORT int sweep_lanes(void) {
#ifdef __x86_64__
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    return 8;
  if (__builtin_cpu_supports("avx2")) return 4;
#endif
  return 2;
}
