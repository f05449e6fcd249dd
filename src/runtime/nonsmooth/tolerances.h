/* Tolerances of gaps and speeds at contacts in an event resolution. */
#pragma once

#include <stddef.h>

struct Resolution;

/*
 * L is the largest coordinate of the present state, V the largest velocity, each at least its nominal value. Where an
 * importer integrates, it keeps constraints less well than the solvers here.
 */
struct Tolerances {
  double touching;     /* gaps that a projection leaves where contacts touch: 1e-12 L, of importers 1e-9 L */
  double penetration;  /* accepted at the start, and after an event sets coordinates: 1e-9, in units of the gap */
  double drift;        /* gaps above which closed contacts have moved apart: 1e-6 L, of importers 1e-3 L */
  double rounded;      /* penetration by start values with four digits, and errors of an importer's step: 1e-4 L */
  double rest;         /* speeds of frictions and closing rates at rest: 1e-9 V, of importers 1e-6 V */
  double acceleration; /* of gaps that a constraint or a vanishing force holds: 1e-9 V in a second */
  double uncertain;    /* rates that uncertain directions of gaps may cause: 1e-6 V, with the square root of 1e-12 */
  double kink;         /* rates that the time to the zero of a branch, or a kink at it, may cause: share of V */
};

/* Returns the tolerances at the present state and accelerations. */
struct Tolerances tolerances_of(const struct Resolution *resolution);

/*
 * Returns the acceleration of a gap up to which it counts as 0, where a constraint fulfils it or a force has just
 * vanished. It is 1000 rounding error bounds, since several errors add up, and at least Tolerances.acceleration.
 */
double rounded_acceleration_of_gap(const struct Resolution *resolution, size_t contact);
