/*
 * Impulses of contacts and frictions: their effects on the velocities, and on one another by the Delassus matrix
 * W = J M^-1 J^T. Contacts come first, then the frictions that rest on them.
 */
#pragma once

#include "nonsmooth/cones/impulses.h"
#include "nonsmooth/contacts/planes.h"
#include "nonsmooth/resolution.h"
#include "instance/active_constraints.h"

/*
 * Collects the contacts that take part, and the frictions on them that do, at the rates in resolution->value; active
 * constraints hold. False, and nothing is allocated, if M is singular or memory is missing.
 */
bool contact_impulses_create(struct Resolution *resolution, struct ContactImpulses *impulses);

/* Return the elements of value[] with the rate of a row, and with its change in time. */
size_t rate_slot(const struct SwitchTable *switches, const struct ContactImpulses *impulses, size_t row);
size_t change_slot(const struct SwitchTable *switches, const struct ContactImpulses *impulses, size_t row);
void contact_impulses_free(const struct Resolution *resolution, struct ContactImpulses *impulses);

/*
 * Computes W_ii of each contact alone: with all contacts open and all frictions sliding. own: contact_count numbers.
 * Restores the modes. False if M is singular.
 */
bool contact_impulses_find_own(struct Resolution *resolution, const struct ContactImpulses *impulses, double *own);

/* True if the contact is closed in the present modes. */
static inline bool contact_is_closed(const struct Resolution *resolution, size_t contact) {
  return contact_holds(resolution->instance, contact);
}

/* Closes or opens a contact. Its constraint has the whole force then. */
void set_contact(struct Resolution *resolution, size_t contact, bool is_closed);

/* Closes a contact that carries a force, to which its constraint adds what the load lacks. */
void contact_carry(struct Resolution *resolution, size_t contact, double force);

/* Opens a contact and lets a force press on it. */
void contact_press(struct Resolution *resolution, size_t contact, double force);

/* Returns a part of a contact's values, such as CONTACT_GAP, from the last evaluation. */
static inline double contact_value(const struct Resolution *resolution, size_t contact, size_t part) {
  return resolution->value[contact_slot(resolution->switches, contact, part)];
}

/* Returns the force of a closed contact; negative if it pulls. */
static inline double contact_force(const struct Resolution *resolution, size_t contact) {
  size_t constraint = resolution->switches->contacts[contact].constraint;
  return resolution->acceleration[lagrangian.coordinate_count + constraint] +
         carried_force(resolution->instance, contact);
}

/* Returns the largest size of the forces of closed contacts. */
double largest_contact_force(const struct Resolution *resolution);

/* Evaluates the values after velocities have changed, with the last accelerations. False if that fails. */
bool evaluate_velocities(struct Resolution *resolution);

/*
 * After velocities were projected: lets frictions in planes that do not stick, and have stopped, slip along their last
 * direction. False if values cannot be evaluated.
 */
bool let_stopped_slip(struct Resolution *resolution);

/* Lets sticking frictions slide if all their contacts are open. */
void let_unpressed_slide(struct Resolution *resolution);

/* Returns the factor of the force of a sliding friction: the sign of the velocity, or a component of its direction. */
double sliding_share(const struct Resolution *resolution, size_t friction);

/* True if the gap is at most 0 within rounding, or its zero has been located at this event. */
bool is_touching(const struct Resolution *resolution, size_t contact);

/* Lets the contacts that touch take part; frictions: the part of all frictions. Returns the number of contacts. */
size_t choose_touching(struct Resolution *resolution, enum Part frictions);

/* True if the contact is closed, or touches and does not open, or its bounce is lost. */
bool contact_is_at_rest(const struct Resolution *resolution, size_t contact);

/* The same if its gap may have any acceleration that contacts have, as with other modes. */
bool contact_may_rest(const struct Resolution *resolution, size_t contact);

/*
 * True if a contact that opens at this rate bounces by less than the errors of rounding and of the method, in
 * height or duration.
 */
bool bounce_is_lost(const struct Resolution *resolution, size_t contact, double rate);

/* The same if others press its bodies together: its gap then closes with any acceleration that gaps have. */
bool bounce_is_lost_beside_others(const struct Resolution *resolution, size_t contact, double rate);
