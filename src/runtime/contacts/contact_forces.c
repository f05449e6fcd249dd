/*
 * The forces F of contacts at rest and the accelerations a of their gaps fulfil a >= 0, F >= 0, F a = 0, where
 *
 *   a = free + S F,   S = mobility of the contacts + that between them and their sliding frictions, mu times.
 *
 * Without friction S is symmetric and there is always one motion. With it there may be none, or several (Painleve's paradox):
 * all combinations of open and closed contacts are then tried out. Contacts whose friction sticks stay as they are.
 */
#include "contacts/contact_forces.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "contacts/planes.h"
#include "contacts/pushes.h"
#include "evaluation/services.h"

/* Of so many contacts that act on one another all combinations are tried out. */
enum { COMBINED_LIMIT = 12 };

/* In units of the largest free acceleration: forces and accelerations that may be rounding, and motions that are the same. */
static const double rounded_force = 1e-9;

/* A pivot below this share of the largest is that of a singular matrix. */
static const double least_share_of_pivot = 1e-11;

/* A contact whose friction leaves less of its mobility is about to lock. */
static const double locking_share = 1e-3;

static const char no_pushes[] = "the forces of contacts cannot be found there";

/* In units in which the mobility of each contact by itself is 1. */
struct RestingContacts {
  struct Pushes pushes;
  size_t count;
  double *s, *free;       /* S by rows, and the free accelerations */
  double *force, *motion; /* of the combination that is tried out; its accelerations */
  double *found;          /* the accelerations of the first solution */
  double *found_force;
  double *matrix; /* count + 1 columns */
  double *unit;
  void *block;
};

static bool sticks_on(const struct Settlement *settlement, size_t contact) {
  const struct SwitchTable *switches = settlement->switches;
  bool sticks = false;
  for (size_t i = 0; i < switches->friction_count; i++)
    sticks |= rests_on(switches, i, contact) && friction_sticks(settlement, i);
  return sticks;
}

/* Whether an open contact at rest would close, as one that another has opened too soon. */
static bool sinks(const struct Settlement *settlement) {
  bool any = false;
  for (size_t i = 0; i < settlement->switches->contact_count; i++) {
    size_t place = contact_place(settlement->switches, i, CONTACT_ACCELERATION);
    any |= !contact_is_closed(settlement, i) && settlement->takes_part[i] != 0.0 &&
           settlement->value[place] < -settlement->noise[place];
  }
  return any;
}

/* Which contacts may open or close by their forces, and which frictions slide. Whether such a friction rests on any. */
static bool choose_resting(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  size_t contacts = switches->contact_count;
  bool slides = false;
  for (size_t i = 0; i < contacts; i++)
    settlement->takes_part[i] = contact_is_at_rest(settlement, i) && !sticks_on(settlement, i) ? 1.0 : 0.0;
  for (size_t i = 0; i < switches->friction_count; i++) {
    settlement->takes_part[contacts + i] = friction_sticks(settlement, i) ? 0.0 : 1.0;
    for (size_t k = 0; k < contacts; k++)
      slides |= settlement->takes_part[k] * settlement->takes_part[contacts + i] != 0.0 && rests_on(switches, i, k);
  }
  return slides;
}

/* The pushes while the contacts that take part are open. */
static bool find_pushes(struct Settlement *settlement, struct Pushes *pushes) {
  const struct SwitchTable *switches = settlement->switches;
  bool changed = settlement->changed;
  settlement_keep_modes(settlement);
  for (size_t i = 0; i < switches->contact_count; i++)
    if (settlement->takes_part[i] != 0.0) set_contact(settlement, i, false);
  bool done = pushes_create(settlement, pushes);
  settlement_restore_modes(settlement);
  settlement->changed = changed;
  return done;
}

/* How the push of one contact, with its frictions, moves the gap of another. */
static double mobility_with_friction(const struct Settlement *settlement, const struct Pushes *pushes, size_t i,
                                     size_t j) {
  size_t contacts = pushes->contact_count;
  double sum = pushes->mobility[i * pushes->count + j];
  for (size_t f = 0; f < pushes->friction_count; f++) {
    double against = sliding_share(settlement, pushes->member[contacts + f]) * pushes->coefficient[f * contacts + j];
    sum -= against * pushes->mobility[i * pushes->count + contacts + f];
  }
  return sum;
}

/* S, and the free accelerations from those at the present forces. */
static void fill_resting(const struct Settlement *settlement, struct RestingContacts *resting) {
  const struct Pushes *pushes = &resting->pushes;
  size_t n = resting->count;
  for (size_t i = 0; i < n; i++) resting->unit[i] = 1.0 / sqrt(pushes->mobility[i * pushes->count + i]);
  for (size_t i = 0; i < n; i++) {
    resting->free[i] = contact_value(settlement, pushes->member[i], CONTACT_ACCELERATION) * resting->unit[i];
    for (size_t j = 0; j < n; j++) {
      const struct ContactFacts *contact = &settlement->switches->contacts[pushes->member[j]];
      double force = settlement->acceleration[lagrangian.coordinate_count + contact->constraint];
      double s = mobility_with_friction(settlement, pushes, i, j) * resting->unit[i] * resting->unit[j];
      resting->s[i * n + j] = s;
      if (contact_is_closed(settlement, pushes->member[j])) resting->free[i] -= s * force / resting->unit[j];
    }
  }
}

static void free_resting(const struct Settlement *settlement, struct RestingContacts *resting) {
  if (resting->block != NULL) scratch_return(settlement->instance, SCRATCH_RESTING);
  pushes_free(settlement, &resting->pushes);
}

/* False where a contact cannot be moved, and where there is a problem: M is singular, or there is no memory. */
static bool create_resting(struct Settlement *settlement, struct RestingContacts *resting, const char **problem) {
  *resting = (struct RestingContacts){0};
  *problem = NULL;
  if (!find_pushes(settlement, &resting->pushes)) {
    *problem = no_pushes;
    return false;
  }
  size_t n = resting->count = resting->pushes.contact_count;
  resting->block = scratch_take(settlement->instance, SCRATCH_RESTING, (2 * n * (n + 1) + 6 * n) * sizeof(double));
  bool moves = true;
  for (size_t i = 0; i < n; i++) moves &= resting->pushes.mobility[i * resting->pushes.count + i] > DBL_MIN;
  if (resting->block == NULL) {
    solver_lacks_memory(settlement->instance);
    *problem = no_pushes;
  }
  if (resting->block == NULL || !moves) {
    free_resting(settlement, resting);
    return false;
  }
  resting->s = resting->block;
  resting->free = resting->s + n * n;
  resting->force = resting->free + n;
  resting->motion = resting->force + n;
  resting->found = resting->motion + n;
  resting->found_force = resting->found + n;
  resting->unit = resting->found_force + n;
  resting->matrix = resting->unit + n;
  fill_resting(settlement, resting);
  return true;
}

/* Whether the symmetric part of S is positive, so that there is one motion: by Cholesky's factors. */
static bool is_surely_one(const struct RestingContacts *resting) {
  size_t n = resting->count;
  double *l = resting->matrix;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++) {
      double sum = 0.5 * (resting->s[i * n + j] + resting->s[j * n + i]);
      for (size_t k = 0; k < j; k++) sum -= l[i * n + k] * l[j * n + k];
      if (i == j && !(sum > locking_share * locking_share)) return false;
      l[i * n + j] = i == j ? sqrt(sum) : sum / l[j * n + j];
    }
  return true;
}

/* The forces that hold the contacts of a combination, by Gauss elimination. False where S is singular. */
static bool find_forces(const struct RestingContacts *resting, unsigned combination) {
  size_t n = resting->count, member[COMBINED_LIMIT], count = 0;
  double *a = resting->matrix;
  for (size_t i = 0; i < n; i++)
    if ((combination >> i & 1u) != 0) member[count++] = i;
  size_t width = count + 1;
  for (size_t i = 0; i < count; i++) {
    for (size_t j = 0; j < count; j++) a[i * width + j] = resting->s[member[i] * n + member[j]];
    a[i * width + count] = -resting->free[member[i]];
  }
  for (size_t k = 0; k < count; k++) {
    size_t best = k;
    for (size_t i = k + 1; i < count; i++)
      if (fabs(a[i * width + k]) > fabs(a[best * width + k])) best = i;
    if (!(fabs(a[best * width + k]) > least_share_of_pivot)) return false;
    for (size_t j = 0; j < width; j++) {
      double other = a[k * width + j];
      a[k * width + j] = a[best * width + j];
      a[best * width + j] = other;
    }
    for (size_t i = 0; i < count; i++) {
      double share = i == k ? 0.0 : a[i * width + k] / a[k * width + k];
      for (size_t j = k; j < width; j++) a[i * width + j] -= share * a[k * width + j];
    }
  }
  memset(resting->force, 0, n * sizeof *resting->force);
  for (size_t i = 0; i < count; i++) resting->force[member[i]] = a[i * width + count] / a[i * width + i];
  return true;
}

/* Whether the forces of a combination press, and no gap closes. */
static bool is_solution(const struct RestingContacts *resting, double size) {
  size_t n = resting->count;
  bool is_fine = true;
  for (size_t i = 0; i < n; i++) {
    double change = 0.0, terms = size;
    for (size_t j = 0; j < n; j++) {
      change += resting->s[i * n + j] * resting->force[j];
      terms = fmax(terms, fabs(resting->s[i * n + j] * resting->force[j]));
    }
    resting->motion[i] = resting->free[i] + change;
    is_fine &= resting->force[i] >= -rounded_force * size && resting->motion[i] >= -rounded_force * terms;
  }
  return is_fine;
}

static bool is_same_motion(const struct RestingContacts *resting, double size) {
  double change = 0.0, terms = size;
  for (size_t i = 0; i < resting->count; i++) {
    change = fmax(change, fabs(resting->motion[i] - resting->found[i]));
    terms = fmax(terms, fabs(resting->force[i]));
  }
  return change <= 1e3 * rounded_force * terms;
}

/* Tries all combinations out: how many motions there are, 2 for more than one, and the forces of the first. */
static int count_solutions(const struct RestingContacts *resting) {
  size_t n = resting->count, bytes = n * sizeof(double);
  double size = 0.0;
  int count = 0;
  for (size_t i = 0; i < n; i++) size = fmax(size, fabs(resting->free[i]));
  for (unsigned combination = 0; combination < 1u << n && count < 2; combination++) {
    if (!find_forces(resting, combination) || !is_solution(resting, size)) continue;
    if (count > 0 && is_same_motion(resting, size)) continue;
    if (count++ > 0) continue;
    memcpy(resting->found, resting->motion, bytes);
    memcpy(resting->found_force, resting->force, bytes);
  }
  return count;
}

/* The contact that its frictions leave least of its mobility. */
static size_t find_locked(const struct RestingContacts *resting) {
  size_t locked = 0, n = resting->count;
  for (size_t i = 1; i < n; i++)
    if (resting->s[i * n + i] < resting->s[locked * n + locked]) locked = i;
  return locked;
}

/* The friction that takes most of a contact's mobility. */
static const char *locking_friction(const struct Settlement *settlement, const struct Pushes *pushes, size_t contact) {
  size_t contacts = pushes->contact_count, most = 0;
  double taken = -INFINITY;
  for (size_t f = 0; f < pushes->friction_count; f++) {
    double takes = sliding_share(settlement, pushes->member[contacts + f]) *
                   pushes->coefficient[f * contacts + contact] *
                   pushes->mobility[contact * pushes->count + contacts + f];
    if (takes > taken) most = f;
    taken = fmax(takes, taken);
  }
  return settlement->switches->frictions[pushes->member[contacts + most]].name;
}

static const char *refuse_forces(const struct Settlement *settlement, const struct RestingContacts *resting,
                                 const char *how_many) {
  const struct Pushes *pushes = &resting->pushes;
  size_t contact = find_locked(resting);
  log_message(
      settlement->instance, settlement->occasion == AT_START ? STATUS_ERROR : STATUS_DISCARD,
      "time %g: the force of the contact '%s' has %s solution there, as the friction '%s' slides and presses it "
      "together (Painleve's paradox); expected less friction, or another position",
      settlement->time, settlement->switches->contacts[pushes->member[contact]].name, how_many,
      locking_friction(settlement, pushes, contact));
  return "forces of contacts with friction are not determined";
}

/* What rests on a contact that closes slides as it moves: it may have been let go as the contact opened. */
static void let_slide(struct Settlement *settlement, size_t contact) {
  for (size_t i = 0; i < settlement->switches->friction_count; i++)
    if (is_in_plane(settlement->switches, i) && rests_on(settlement->switches, i, contact))
      set_friction(settlement, i, 1.0);
}

/* Opens and closes the contacts as the solution says. Whether that changes any. */
static bool take_solution(struct Settlement *settlement, const struct RestingContacts *resting) {
  bool changes = false;
  double size = 0.0;
  for (size_t i = 0; i < resting->count; i++) size = fmax(size, fabs(resting->free[i]));
  for (size_t i = 0; i < resting->count; i++) {
    size_t contact = resting->pushes.member[i];
    bool is_closed = contact_is_closed(settlement, contact);
    bool presses = resting->found_force[i] > rounded_force * size, parts = resting->found[i] > rounded_force * size;
    if (is_closed ? !parts : !presses) continue;
    set_contact(settlement, contact, !is_closed);
    if (!is_closed) let_slide(settlement, contact);
    settlement->was_opened[contact] = is_closed ? 1.0 : 0.0;
    changes = true;
  }
  return changes;
}

const char *contact_forces_settle(struct Settlement *settlement, bool *again) {
  struct RestingContacts resting;
  *again = false;
  const char *problem = NULL;
  if (!choose_resting(settlement) || !create_resting(settlement, &resting, &problem)) return problem;
  bool closes = sinks(settlement);
  if (resting.count <= COMBINED_LIMIT && (closes || !is_surely_one(&resting))) {
    int count = count_solutions(&resting);
    /* What neither sinks nor pulls is a solution, though others may share its forces in another way, and rounding hide it. */
    if (count == 1) *again = closes && take_solution(settlement, &resting);
    else if (count > 1 || closes) problem = refuse_forces(settlement, &resting, count > 1 ? "more than one" : "no");
  }
  free_resting(settlement, &resting);
  return problem;
}
