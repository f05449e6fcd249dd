/* Existence and uniqueness of the forces of contacts at rest, with the frictions that slide on them. */
#pragma once

#include "nonsmooth/cones/impulses.h"
#include "nonsmooth/contacts/resting_forces.h"
#include "nonsmooth/resolution.h"

/*
 * Opens and closes contacts at rest according to the solution for their forces; sets *again if any changed. Warns once
 * if the solution was not shown to be the only one. Returns NULL, or, after logging contact and friction, the reason
 * why the motion cannot continue.
 */
const char *contact_forces_resolve(struct Resolution *resolution, bool *again);

/*
 * Logs a contact that closes whatever its impulse, and one that opposes it: prescribed motions crush a body between
 * them. Returns the reason why the motion cannot continue.
 */
const char *contact_forces_report_crushed(struct Resolution *resolution, size_t contact);

/* Logs a contact that closes although no force changes its gap. */
void contact_forces_report_fixed(const struct Resolution *resolution, size_t contact);

/* The problem of the contacts that take part; forces are in units of unit[]. */
struct RestingContacts {
  struct ContactImpulses impulses;
  struct RestingForces forces;
  double *unit;                    /* unit of the force of each contact: 1 / sqrt(W_ii) */
  enum RestingSolutions solutions; /* their number; ONE_MOTION if it is not examined */
  void *block;
};

/* The names in a message about missing forces; NULL for none. */
struct Paradox {
  const char *contact, *friction;
};

/*
 * Lets the contacts at rest without sticking friction and the frictions that slide take part. True if a
 * selected friction rests on a selected contact.
 */
bool choose_resting(struct Resolution *resolution);

/*
 * Sets up the problem. False, with *problem NULL, if no selected contact can move; with the reason, if M is singular or
 * memory is missing.
 */
bool create_resting(struct Resolution *resolution, struct RestingContacts *resting, const char **problem);
void free_resting(const struct Resolution *resolution, struct RestingContacts *resting);
