/* Forces of frictions at rest, and of the contacts that take part, all at once. */
#pragma once

#include "nonsmooth/cones/impulses.h"
#include "nonsmooth/planes/plane_state.h"

/* Relative to the largest stiction: forces that exceed a limit by less are at the limit. */
static const double share_at_limit = 1e-9;

/*
 * The unknown forces: a row for each contact, two for each friction in a plane, one for each along a line. The arrays of
 * frictions have an element, or a row of n, for each of their rows.
 */
struct RestForces {
  struct Resolution *resolution;
  struct ContactImpulses impulses;   /* derivatives of a; the limits, which are kinetic ones if the friction slips */
  size_t n, lines;                   /* number of rows; the first row of a friction along a line */
  double pressure;                   /* force of each contact, in N, around which the functions are read */
  double *free;                      /* a without forces */
  double *force, *behind;            /* the forces, and a with them */
  double *stiction, *given_stiction; /* derivatives of the stiction, and stiction without forces */
  double *kinetic, *given_kinetic;   /* the same for the kinetic friction */
  double *load, *missing;            /* of carried_forces.c: n, and 3 n */
  double *slips;                     /* 1 if the friction slips: its limit is the kinetic friction */
  double none;                       /* accelerations that count as 0 */
  bool continues;                    /* the forces are near those in guess[] of the event resolution */
};

static inline enum Part *part_of_plane(const struct Resolution *resolution, const struct PlaneState *state) {
  return part_of_friction(resolution, state->metadata->along);
}

/* Returns the state of the friction in a plane of a row. */
static inline struct PlaneState state_of_row(const struct RestForces *forces, size_t row) {
  const struct Resolution *resolution = forces->resolution;
  return plane_state(resolution, plane_of(resolution->switches, forces->impulses.member[row]));
}

/* True if the friction of a row slips by the solution. */
static inline bool rest_slips(const struct RestForces *forces, size_t row) {
  return forces->slips[row - forces->impulses.contact_count] != 0.0;
}

/*
 * True if the force of a friction at rest is unknown. It is found in units of the kinetic friction, which is less than 0
 * where its contact would have to pull so that all stick.
 */
bool rest_is_unknown(const struct Resolution *resolution, size_t friction);

/* True if a row is that of a friction along a line. */
static inline bool row_is_of_line(const struct RestForces *forces, size_t row) {
  return row >= forces->lines;
}

/* Returns the number of rows of the friction of a row. */
static inline size_t rows_of_friction(const struct RestForces *forces, size_t row) {
  return row_is_of_line(forces, row) ? 1 : 2;
}

/* Returns the largest stiction of all frictions. */
double largest_stiction(const struct Resolution *resolution);

/*
 * Finds the forces of the contacts that take part, and of the frictions that do and have kinetic friction. The others
 * keep their modes. False, and nothing is allocated, if there are none, or accelerations or memory are missing. Modes
 * change to those with which the functions were read.
 */
bool rest_forces_find(struct RestForces *forces);
void rest_forces_free(const struct RestForces *forces);

/* Returns the kinetic friction of a row with the forces that were found. */
double rest_forces_kinetic(const struct RestForces *forces, size_t row);
