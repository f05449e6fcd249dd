/* The rows of a problem of contacts and frictions, and the energy that impulses make. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Rows are the contacts that take part, then the frictions on them. delassus is symmetric and positive semidefinite. */
struct ContactImpulses {
  size_t contact_count, friction_count, count; /* count: the sum of both */
  size_t *member;                              /* indices of contacts, then of frictions, in the switch table */
  double *velocities;                          /* count rows: change of the velocities by each unit impulse */
  double *delassus;                            /* count rows: Delassus matrix */
  double *rate;                                /* of the gaps, and the velocities of the frictions */
  double rounding;                             /* rounding error bound of the rates */
  double uncertain;                            /* rates that uncertain directions of the gaps may cause */
  size_t deciding_count; /* leading rows on whose impulses friction limits depend: those of the contacts, or all */
  double *coefficient;   /* friction_count rows: friction limit by a unit impulse of each of them */
  double *given;         /* friction limits without them; NULL for none */
  /* Workspace: rows of the Jacobian; an impulse of 0 on each coordinate and constraint, its response, and values. */
  double *jacobian_row, *impulse, *response, *value;
  void *block;
};

/* Returns the friction limit of a row with impulses. */
double limit_with(const struct ContactImpulses *impulses, const double *impulse, size_t row);

/* Returns the change of the rate of a row by impulses, of W p. */
double change_of_rate(const struct ContactImpulses *impulses, const double *impulse, size_t row);

/* True if the work of the impulses is positive beyond rounding. */
bool gains_energy(const struct ContactImpulses *impulses, const double *impulse);

/* True if impulses cause another motion than found, beyond rounding, and gain no energy. */
bool is_other_outcome(const struct ContactImpulses *impulses, const double *impulse, const double *found);
