/* Laws of sliding contacts, whose frictions follow from their forces: jams, and slips without forces. */
#include <math.h>

#include "evaluation/services.h"
#include "nonsmooth/contacts/contact_forces.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/contacts/planes.h"
#include "nonsmooth/sliding/end_slip.h"

/* Contacts jam if friction reduces their diagonal element of S to less than this fraction of that of W. */
static const double jamming_share = 1e-3;

/* Returns the row with the least diagonal element of S, where friction opposes the motion of the gap most. */
static size_t find_locked(const struct RestingContacts *resting) {
  const struct RestingForces *forces = &resting->forces;
  size_t locked = 0, n = forces->count;
  for (size_t i = 1; i < n; i++)
    if (forces->s[i * n + i] < forces->s[locked * n + locked]) locked = i;
  return locked;
}

/* Returns the name of the friction that reduces the diagonal element of S most. */
static const char *locking_friction(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                                    size_t contact) {
  size_t contacts = impulses->contact_count, most = 0;
  double taken = -INFINITY;
  for (size_t f = 0; f < impulses->friction_count; f++) {
    double takes = sliding_share(resolution, impulses->member[contacts + f]) *
                   impulses->coefficient[f * contacts + contact] *
                   impulses->delassus[contact * impulses->count + contacts + f];
    if (takes > taken) most = f;
    taken = fmax(takes, taken);
  }
  return resolution->switches->frictions[impulses->member[contacts + most]].name;
}

static void find_paradox(const struct Resolution *resolution, const struct RestingContacts *resting,
                         struct Paradox *paradox) {
  size_t row = find_locked(resting);
  *paradox = (struct Paradox){.contact = resolution->switches->contacts[resting->impulses.member[row]].name,
                              .friction = locking_friction(resolution, &resting->impulses, row)};
}

static bool find_all_forces(struct Resolution *resolution) {
  return resolution->switches->friction_laws->resolve_together(resolution) || resolution_ends_slip(resolution);
}

static const char *resolve_paradox(struct Resolution *resolution, const struct Paradox *paradox, bool *again) {
  *again = find_all_forces(resolution);
  if (*again) return NULL;
  log_message(resolution->instance, resolution_status(resolution),
              "time %g: no force of the contact '%s' is found, as the friction '%s' slides and presses it "
              "together (Painleve's paradox); expected less friction, or another position",
              resolution->time, paradox->contact, paradox->friction);
  return "forces of contacts with friction are not determined";
}

static void report_others(const struct Resolution *resolution, const struct RestingContacts *resting) {
  const struct ContactImpulses *impulses = &resting->impulses;
  size_t contact = find_locked(resting);
  if (resolution->instance->reported_other_forces) return;
  resolution->instance->reported_other_forces = true;
  log_message(
      resolution->instance, STATUS_WARNING,
      "time %g: the forces of sliding contacts, such as '%s' with the friction '%s', may have another solution; "
      "the motion is one that damped compliant contacts would have",
      resolution->time, resolution->switches->contacts[impulses->member[contact]].name,
      locking_friction(resolution, impulses, contact));
}

static bool any_begins_to_slide(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  double slowest = resolution->tolerances.rest;
  bool begins = false;
  for (size_t i = 0; i < switches->friction_count; i++) {
    if (friction_sticks(resolution, i) || !(sliding_speed(resolution, i) <= slowest)) continue;
    for (size_t k = 0; k < switches->contact_count; k++)
      begins |= resolution->part[k] != LEFT_OUT && rests_on(switches, i, k);
  }
  return begins;
}

/*
 * Returns the acceleration of gap j by forces of two contacts whose sum is 1, and whose accelerations cancel in gap i.
 * INFINITY if no forces that press do so. With W_ii = 1 it is 0 where both jam, and of order 1 elsewhere.
 */
static double left_by_pair(double ii, double ij, double ji, double jj) {
  return ij < 0.0 ? (ii * jj - ij * ji) / (ii - ij) : INFINITY;
}

/* True if frictions make two contacts jam each other. False if these oppose each other without friction too. */
static bool jam_together(const struct RestingContacts *resting, size_t i, size_t j) {
  size_t n = resting->forces.count;
  const double *s = resting->forces.s;
  double delassus = resting->impulses.delassus[i * resting->impulses.count + j] * resting->unit[i] * resting->unit[j];
  return left_by_pair(s[i * n + i], s[i * n + j], s[j * n + i], s[j * n + j]) < jamming_share &&
         !(left_by_pair(1.0, delassus, delassus, 1.0) < jamming_share);
}

/* Finds a contact that jams, by itself or with another; the number of contacts if there is none. */
static size_t find_jammed(const struct RestingContacts *resting) {
  size_t n = resting->forces.count, locked = find_locked(resting);
  if (resting->forces.s[locked * n + locked] < jamming_share) return locked;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      if (i != j && jam_together(resting, i, j)) return i;
  return n;
}

static bool explain_jam_of_contact(struct Resolution *resolution) {
  struct RestingContacts resting;
  const char *problem;
  if (!choose_resting(resolution) || !create_resting(resolution, &resting, &problem)) return false;
  size_t contact = find_jammed(&resting);
  bool jams = contact < resting.forces.count;
  if (jams)
    log_message(
        resolution->instance, STATUS_DISCARD,
        "time %g: the friction '%s' slides and presses the contact '%s' together ever more strongly, up to a jam "
        "(Painleve's paradox); expected less friction, or another position",
        resolution->time, locking_friction(resolution, &resting.impulses, contact),
        resolution->switches->contacts[resting.impulses.member[contact]].name);
  free_resting(resolution, &resting);
  return jams;
}

const struct SlidingLaws sliding_laws = {.any_begins = any_begins_to_slide,
                                         .find_paradox = find_paradox,
                                         .find_all_forces = find_all_forces,
                                         .resolve_paradox = resolve_paradox,
                                         .report_others = report_others,
                                         .end_slip = end_slip,
                                         .explain = explain_jam_of_contact};
