/*
 * What contacts and frictions do to the velocities: the pushes of some of them, contacts first, and how these answer to one
 * another.
 */
#ifndef PUSHES_H
#define PUSHES_H

#include "events/settlement.h"
#include "instance/held.h"

struct Pushes {
  size_t contact_count, friction_count, count; /* count: of both */
  size_t *member;                              /* which contacts, then which frictions, of the table */
  double *velocities;                          /* count rows: the change of the velocities by each push of 1 */
  double *mobility;                            /* count rows: the change of the rates by each push of 1 */
  double *rate;                                /* of the gaps, then the velocities of the frictions */
  double rounding;                             /* what it may make of any rate */
  double *coefficient; /* friction_count rows: what each contact's push of 1 lets the friction push */
  void *block;
};

/*
 * Those of the contacts that take part, and of the frictions that do and rest on them; at the rates in settlement->value,
 * while constraints hold as the modes say. False, and nothing is allocated, where M is singular or there is no memory.
 */
bool pushes_create(struct Settlement *settlement, struct Pushes *pushes);
void pushes_free(const struct Settlement *settlement, struct Pushes *pushes);

static inline bool contact_is_closed(const struct Settlement *settlement, size_t contact) {
  return contact_holds(settlement->instance, contact);
}

static inline void set_contact(struct Settlement *settlement, size_t contact, bool is_closed) {
  settlement_set_mode(settlement, settlement->switches->contacts[contact].mode, is_closed ? 1.0 : 0.0);
}

static inline double contact_value(const struct Settlement *settlement, size_t contact, size_t part) {
  return settlement->value[contact_place(settlement->switches, contact, part)];
}

/* What a closed contact presses with; below 0 where it pulls. */
static inline double contact_force(const struct Settlement *settlement, size_t contact) {
  size_t constraint = settlement->switches->contacts[contact].constraint;
  return settlement->acceleration[lagrangian.coordinate_count + constraint];
}

static inline bool friction_sticks(const struct Settlement *settlement, size_t friction) {
  return friction_holds(settlement->instance, friction);
}

/* mode: the sign of its velocity, which one in a plane does not look at; 0 for one that sticks. */
void set_friction(struct Settlement *settlement, size_t friction, double mode);

/* What a friction that slides pushes against its velocity by a force of 1: its sign, or the component of a direction. */
double sliding_share(const struct Settlement *settlement, size_t friction);

/* Whether the friction follows from the force of the contact. */
bool rests_on(const struct SwitchTable *switches, size_t friction, size_t contact);

/* Whether the gap is 0, but for rounding. */
bool is_touching(const struct Settlement *settlement, size_t contact);

/* Whether it is closed, or touches without coming nearer or parting. */
bool contact_is_at_rest(const struct Settlement *settlement, size_t contact);

/* Whether the flight of a contact that parts at this rate would be lost in what rounding, or the method, makes of it. */
bool bounce_is_lost(const struct Settlement *settlement, size_t contact, double rate);

#endif
