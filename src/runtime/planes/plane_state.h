/* Friction in a plane at an event: how fast it slides, what it takes to stick, and its modes. */
#ifndef PLANE_STATE_H
#define PLANE_STATE_H

#include "contacts/planes.h"

/* PLANE_HEADS: it slides along its heading, or freely, without force. */
enum PlaneMode { PLANE_HEADS = -1, PLANE_STICKS = 0, PLANE_SLIDES = 1 };

struct PlaneState {
  const struct PlaneFacts *facts;
  int mode;
  double speed, stiction, sliding;  /* sliding: what it pushes with as it slides */
  bool has_force;                   /* else the contact that it rests on gives none: nothing sticks */
  bool is_free;                     /* it was let slide without force */
  double velocity[2], ahead, aside; /* along and across; the speeds along its heading, and to a side of it */
  double rate[2];                   /* of the velocities along and across */
  double force[2], needed;          /* what it carries, where it sticks, and the size of that */
  double lower, upper; /* speeds at which the mode may change; upper < 0 for none, or back along the heading */
  /*
   * Speeds that count as small, and as none, by the errors of the method. At a small one it is brought to rest at once where it
   * can stick: the push which that takes differs from what friction does until then by the square of the speed.
   */
  double small, none;
  bool has_slowed;      /* the zero was found of its indicator at the lower speed, or at the stiction */
  bool has_sped;        /* at the upper speed */
  bool has_turned_back; /* within a step of an importer, so that it came past rest */
  bool is_given;        /* its velocity is: it never sticks, but rests without force */
  bool is_first;        /* it has not switched in this settlement */
};

struct PlaneState plane_state(const struct Settlement *settlement, size_t plane);

/* Whether it slides by more than none. */
static inline bool plane_moves(const struct PlaneState *state) {
  return state->speed > 2.0 * state->none;
}

/* Whether it may be brought to rest at once. */
bool plane_is_slow(const struct Settlement *settlement, const struct PlaneState *state);

/* Brings the values up to date with the modes; false where there are no accelerations. */
bool plane_evaluate(struct Settlement *settlement);

/* It was looked at once more. */
void plane_count_switch(struct Settlement *settlement, const struct PlaneState *state);

/* Where forces are not determined, it takes its part of them as of those of equally stiff points. */
void plane_stick(struct Settlement *settlement, const struct PlaneState *state);

/* It sticks and takes this force, and beside it such a part of what is missing. */
void plane_carry(struct Settlement *settlement, const struct PlaneState *state, const double force[2]);

/* One that carries a force takes it alone, while others hold it; and again a part of what is missing. */
void plane_push(struct Settlement *settlement, const struct PlaneState *state);
void plane_hold(struct Settlement *settlement, const struct PlaneState *state);

/* Whether this force is less than what it pushes with as it slides. */
bool plane_has_part(const struct Settlement *settlement, const struct PlaneState *state);

/* Lets it slide until it is slow, or else much slower or faster than now. */
void plane_slide(struct Settlement *settlement, const struct PlaneState *state);

/* Lets it move without force. */
void plane_free(struct Settlement *settlement, const struct PlaneState *state);

/* Lets it slide from rest along a heading, of any length but 0, until it goes back or aside. */
void plane_head(struct Settlement *settlement, const struct PlaneState *state, const double heading[2]);

#endif
