/*
 * Simulates many runs of a system at once, a vector lane for each (lane_steps.h); a lane that finishes takes the next
 * run. Start values and parameters vary; outputs are sampled at given times. The functions are thread-safe.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#ifdef _WIN32
#define ENSEMBLE_EXPORT __declspec(dllexport)
#else
#define ENSEMBLE_EXPORT __attribute__((visibility("default")))
#endif

/* An ensemble. Variables are value references. Runs start at time 0, with the system's start values unless varied. */
struct Ensemble {
  size_t varied_count, recorded_count, time_count;
  const unsigned *varied, *recorded;
  const double *times; /* in s, ascending, not negative; the last is the end of the runs, and positive */
  double tolerance;    /* relative; 0: the system's own */
  const double *start; /* values of the varied variables: runs x varied_count */
  double *values;      /* sampled values: runs x time_count x recorded_count */
  bool *needs_fmu;     /* runs that failed or need the FMU: their values are invalid */
};

/* True if the ensemble supports the system, the varied and the recorded variables. */
ENSEMBLE_EXPORT bool ensemble_supports(const struct Ensemble *ensemble);

/* Simulates runs first .. first + count - 1. Returns false if memory is exhausted. */
ENSEMBLE_EXPORT bool ensemble_run(const struct Ensemble *ensemble, size_t first, size_t count);
