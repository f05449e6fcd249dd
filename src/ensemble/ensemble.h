/*
 * Many runs of a system at once: from starts and parameters to values at given times. The runs are integrated in lanes
 * (lane_steps.h), and a lane whose run is over takes the next one. Any number of threads may call the functions.
 */
#ifndef ENSEMBLE_H
#define ENSEMBLE_H

#include <stdbool.h>
#include <stddef.h>

#ifdef _WIN32
#define ENSEMBLE_EXPORT __declspec(dllexport)
#else
#define ENSEMBLE_EXPORT __attribute__((visibility("default")))
#endif

/* Variables are given by their value references. Each run starts at time 0 from the system's own values but for what varies. */
struct Ensemble {
  size_t varied_count, asked_count, time_count;
  const unsigned *varied, *asked;
  const double *times; /* ascending, none before 0; the last is the end of the runs, after 0 */
  double tolerance;    /* relative; 0 for the system's own */
  const double *start; /* of what varies: runs x varied */
  double *values;      /* of what is asked: runs x times x asked */
  bool *is_left;       /* runs that lanes cannot do, or that have no solution: their values mean nothing */
};

/* Whether all that varies can be given, and all that is asked be told. */
ENSEMBLE_EXPORT bool ensemble_serves(const struct Ensemble *ensemble);

/* Does count runs from the first on; false where there is no memory. */
ENSEMBLE_EXPORT bool ensemble_run(const struct Ensemble *ensemble, size_t first, size_t count);

#endif
