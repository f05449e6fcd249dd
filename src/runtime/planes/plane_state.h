/* State of a friction in a plane at an event: speed, stiction and mode. */
#ifndef PLANE_STATE_H
#define PLANE_STATE_H

#include "contacts/planes.h"

/* PLANE_HEADS: it slides along its slip direction, or freely, without force. */
enum PlaneMode { PLANE_HEADS = -1, PLANE_STICKS = 0, PLANE_SLIDES = 1 };

struct PlaneState {
  const struct PlaneFacts *facts;
  int mode;
  double speed, stiction, sliding;  /* sliding: its force while it slides */
  bool has_force;                   /* else the contact below it has no force: nothing sticks */
  bool is_free;                     /* it slides without force */
  double velocity[2], ahead, aside; /* along and across; speeds along its slip direction, and aside of it */
  double rate[2];                   /* rates of the velocities along and across */
  double force[2], needed;          /* that it carries if it sticks, and its size */
  double lower, upper;              /* speeds at which the mode may change; upper < 0: none, or backwards */
  /*
   * Speeds that count as small, and as 0, within the errors of the method. At a small speed the friction is brought to
   * rest at once if it can stick; the error is of the second order in the speed.
   */
  double small, none;
  bool has_slowed;      /* the zero of its indicator at the lower speed, or at the stiction, was located */
  bool has_sped;        /* the zero of its indicator at the upper speed was located */
  bool has_turned_back; /* it passed rest within a step of an importer */
  bool is_given;        /* its motion is prescribed: it never sticks, but rests without force */
  bool is_first;        /* it has not switched in this event resolution */
};

struct PlaneState plane_state(const struct Settlement *settlement, size_t plane);

/* True if it slides faster than counts as 0. */
static inline bool plane_moves(const struct PlaneState *state) {
  return state->speed > 2.0 * state->none;
}

/* True if it may be brought to rest at once. */
bool plane_is_slow(const struct Settlement *settlement, const struct PlaneState *state);

/* Evaluates the values for the present modes; false if accelerations do not exist. */
bool plane_evaluate(struct Settlement *settlement);

/* Counts a switch of the friction. */
void plane_count_switch(struct Settlement *settlement, const struct PlaneState *state);

/* Lets it stick. If forces are not determined, it takes the share of an equally stiff point. */
void plane_stick(struct Settlement *settlement, const struct PlaneState *state);

/* Lets it stick with this force, and with such a share of the rest. */
void plane_carry(struct Settlement *settlement, const struct PlaneState *state, const double force[2]);

/* push: applies the force that it carries, while others hold it. hold: sticks again, with a share of the rest. */
void plane_push(struct Settlement *settlement, const struct PlaneState *state);
void plane_hold(struct Settlement *settlement, const struct PlaneState *state);

/* True if its force is less than while it slides. */
bool plane_has_part(const struct Settlement *settlement, const struct PlaneState *state);

/* Lets it slide until it is slow, or else much slower or faster than at present. */
void plane_slide(struct Settlement *settlement, const struct PlaneState *state);

/* Lets it move without force. */
void plane_free(struct Settlement *settlement, const struct PlaneState *state);

/* Lets it slide from rest along a direction, of any length but 0, until it goes back or aside. */
void plane_head(struct Settlement *settlement, const struct PlaneState *state, const double heading[2]);

#endif
