/* State of a friction in a plane at an event: speed, stiction and mode. */
#pragma once

#include "nonsmooth/contacts/planes.h"

/*
 * A friction in a plane with its values at the present modes. It is computed from struct Resolution, and changes
 * nothing there.
 */
struct PlaneState {
  const struct PlaneMetadata *metadata;
  enum PlaneMode mode;
  double speed, stiction, sliding;  /* speed; largest static and kinetic friction force */
  bool has_force;                   /* false: its contacts are open and have no force, nothing sticks */
  double velocity[2], ahead, aside; /* along and across; components along the slip direction, and aside */
  double rate[2];                   /* rates of the velocities along and across */
  double force[2], needed;          /* force that it carries if it sticks, and its size */
  double lower, upper;              /* speeds at which the mode may change */
  /*
   * Speeds that count as small, and as 0, within the errors of the method. At a small speed the friction is brought
   * to rest at once if it can stick. The error is of the second order in the speed.
   */
  double small, none;
  bool has_slowed;   /* the zero of its first indicator was located: lower speed, or stiction */
  bool has_sped;     /* the zero of its second indicator was located: upper speed */
  bool has_reversed; /* it passed rest within a step of an importer */
  bool is_given;     /* its motion is prescribed: it never sticks, but rests without force */
  bool is_first;     /* it has not switched in this event resolution */
};

/* Returns the state of a friction in a plane from the last evaluation. */
struct PlaneState plane_state(const struct Resolution *resolution, size_t plane);

/* True if the friction slides, with its force against the velocity. */
static inline bool plane_slides(const struct PlaneState *state) {
  return state->mode == PLANE_SLIDES || state->mode == PLANE_CREEPS;
}

/* True if it has a force along a fixed direction, without constraints. */
static inline bool plane_has_direction(const struct PlaneState *state) {
  return state->mode == PLANE_IMPENDS || state->mode == PLANE_CARRIES;
}

/* True if the friction slides faster than counts as 0. */
static inline bool plane_moves(const struct PlaneState *state) {
  return state->speed > 2.0 * state->none;
}

/* True if the friction may be brought to rest at once; at the start only if its speed counts as 0. */
bool plane_is_slow(const struct Resolution *resolution, const struct PlaneState *state);

/* Evaluates the values for the present modes; false if accelerations do not exist. */
bool plane_evaluate(struct Resolution *resolution);

/* Counts a switch of the friction. */
void plane_count_switch(struct Resolution *resolution, const struct PlaneState *state);

/*
 * Lets the friction stick only by its constraint. If forces are not unique, the constraint carries its share of those
 * of least norm.
 */
void plane_stick(struct Resolution *resolution, const struct PlaneState *state);

/* Lets the friction stick with a given force; its constraint carries the rest of the load. */
void plane_carry(struct Resolution *resolution, const struct PlaneState *state, const double force[2]);

/* Keeps the given force of a friction without its constraint, where others keep its velocity at 0. */
void plane_release(struct Resolution *resolution, const struct PlaneState *state);

/* Lets the friction slide until it is slow; a slow one until it is much slower or faster than at present. */
void plane_slide(struct Resolution *resolution, const struct PlaneState *state);

/* Lets the friction move without force. */
void plane_free(struct Resolution *resolution, const struct PlaneState *state);

/*
 * Lets the friction slide from rest along a direction, of any length, until the velocity leaves this direction. A
 * direction of 0 keeps the last one.
 */
void plane_slip(struct Resolution *resolution, const struct PlaneState *state, const double slip_direction[2]);
