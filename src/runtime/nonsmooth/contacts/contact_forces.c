/*
 * Forces F of contacts at rest, with Coulomb friction of the sliding frictions on them. The problem is linear
 * complementarity for the accelerations a of the gaps:
 *
 *   a = free + S F,   a >= 0,   F >= 0,   F^T a = 0,   S = W_NN - W_NT D mu,
 *
 * where W = J M^-1 J^T is the Delassus matrix of contacts (N) and sliding frictions (T). The diagonal matrix D has
 * the signs (in planes the components) of the slip directions, and mu the friction limits by unit contact forces.
 * Contacts with a friction that sticks are left as they are. Without friction S is symmetric and positive
 * semidefinite, and the accelerations are unique. With it there may be no solution or several (Painleve's paradox).
 *
 * The problem is set up after the frictions have their modes, if a contact approaches. A closed one does so where its
 * constraint contradicts others. Where nothing slides, open ones count only if their force has opened them. The solution
 * sets the contacts. If none is found, an impulse may end the slip (sliding_laws.c). Else the motion ends with a message.
 *
 * If no contact approaches, the present forces are a solution. At the start their stability is examined
 * (resting_forces.c). It is not while a friction begins to slide, since its direction would differ in another solution.
 */
#include "nonsmooth/contacts/contact_forces.h"

#include <float.h>
#include <math.h>

#include "nonsmooth/contacts/planes.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/contacts/resting_forces.h"
#include "nonsmooth/tolerances.h"
#include "evaluation/services.h"

/*
 * Rounding error of an acceleration that other contacts keep at 0. It is a share of the largest free acceleration, or
 * of that by the largest contact force.
 */
static const double rounded_acceleration = 1e-12;

/*
 * The same for a contact that its force has opened: its direction is uncertain (struct Tolerances). If the gap does
 * close, its next zero is another event.
 */
static const double uncertain_acceleration = 1e-6;

/*
 * A contact cannot move if the held contacts and frictions leave less than this fraction of its W_ii. It is the squared
 * sine of the angle between them. Where the contact follows from them, it is rounding.
 */
static const double smallest_share_of_motion = 1e-10;

static const char crushed[] = "contacts crush a body between them";
static const char no_contact_impulses[] = "the forces of contacts cannot be found";

static bool sticks_on(const struct Resolution *resolution, size_t contact) {
  const struct SwitchTable *switches = resolution->switches;
  bool sticks = false;
  for (size_t i = 0; i < switches->friction_count; i++)
    sticks |= rests_on(switches, i, contact) && friction_sticks(resolution, i);
  return sticks;
}

/* Returns the rounding error bound of the acceleration; a larger one for a contact whose force has just vanished. */
static double error_bound_of_acceleration(const struct Resolution *resolution, size_t contact) {
  bool parts = resolution->forced[contact] != UNFORCED;
  return parts ? rounded_acceleration_of_gap(resolution, contact)
               : resolution->error_bound[contact_slot(resolution->switches, contact, CONTACT_ACCELERATION)];
}

/* True if a contact closes. A closed one does so where its constraint contradicts others, as under a hand that lifts. */
static bool sinks(const struct Resolution *resolution, size_t contact) {
  bool is_closed = contact_is_closed(resolution, contact);
  double bound =
      is_closed ? rounded_acceleration_of_gap(resolution, contact) : error_bound_of_acceleration(resolution, contact);
  return contact_value(resolution, contact, CONTACT_ACCELERATION) < -bound;
}

/* True if a contact that takes part sinks. Where nothing slides, open ones count only if their force has opened them. */
static bool any_sinks(const struct Resolution *resolution, bool slides) {
  bool any = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    any |= (slides || contact_is_closed(resolution, i) || resolution->forced[i] == FORCED_OPEN) &&
           resolution->part[i] != LEFT_OUT && sinks(resolution, i);
  return any;
}

bool choose_resting(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  size_t contacts = switches->contact_count;
  bool slides = false;
  for (size_t i = 0; i < contacts; i++)
    resolution->part[i] = contact_is_at_rest(resolution, i) && !sticks_on(resolution, i) ? TAKES_PART : LEFT_OUT;
  for (size_t i = 0; i < switches->friction_count; i++) {
    *part_of_friction(resolution, i) = friction_sticks(resolution, i) ? LEFT_OUT : TAKES_PART;
    for (size_t k = 0; k < contacts; k++)
      slides |=
          resolution->part[k] != LEFT_OUT && *part_of_friction(resolution, i) != LEFT_OUT && rests_on(switches, i, k);
  }
  return slides;
}

/* Computes the Delassus matrix with the selected contacts open; restores the modes. */
static bool find_contact_impulses(struct Resolution *resolution, struct ContactImpulses *impulses) {
  const struct SwitchTable *switches = resolution->switches;
  bool changed = resolution->changed;
  resolution_keep_modes(resolution);
  for (size_t i = 0; i < switches->contact_count; i++)
    if (resolution->part[i] != LEFT_OUT) set_contact(resolution, i, false);
  bool done = contact_impulses_create(resolution, impulses);
  resolution_restore_modes(resolution);
  resolution->changed = changed;
  return done;
}

/* Returns S_ij: the acceleration of gap i by a unit force of contact j with its sliding frictions. */
static double delassus_with_friction(const struct Resolution *resolution, const struct ContactImpulses *impulses,
                                     size_t i, size_t j) {
  size_t contacts = impulses->contact_count;
  double sum = impulses->delassus[i * impulses->count + j];
  for (size_t f = 0; f < impulses->friction_count; f++) {
    double against =
        sliding_share(resolution, impulses->member[contacts + f]) * impulses->coefficient[f * contacts + j];
    sum -= against * impulses->delassus[i * impulses->count + contacts + f];
  }
  return sum;
}

/*
 * Fills S, scaled by the units, and the free accelerations: the present ones minus those that the present forces cause.
 */
static void fill_resting(const struct Resolution *resolution, struct RestingContacts *resting) {
  const struct ContactImpulses *impulses = &resting->impulses;
  struct RestingForces *forces = &resting->forces;
  size_t n = forces->count;
  for (size_t i = 0; i < n; i++) resting->unit[i] = 1.0 / sqrt(impulses->delassus[i * impulses->count + i]);
  for (size_t i = 0; i < n; i++) {
    forces->free[i] = contact_value(resolution, impulses->member[i], CONTACT_ACCELERATION) * resting->unit[i];
    for (size_t j = 0; j < n; j++) {
      double force = contact_force(resolution, impulses->member[j]);
      double s = delassus_with_friction(resolution, impulses, i, j) * resting->unit[i] * resting->unit[j];
      forces->s[i * n + j] = s;
      if (contact_is_closed(resolution, impulses->member[j])) forces->free[i] -= s * force / resting->unit[j];
    }
  }
  for (size_t j = 0; j < n; j++) {
    bool is_closed = contact_is_closed(resolution, impulses->member[j]);
    forces->present[j] = is_closed ? contact_force(resolution, impulses->member[j]) / resting->unit[j] : 0.0;
  }
}

void contact_forces_report_fixed(const struct Resolution *resolution, size_t contact) {
  log_message(resolution->instance, resolution_status(resolution),
              "time %g: the contact '%s' closes by prescribed motions alone; expected prescribed motions that keep the "
              "gap open, or a free coordinate in the gap",
              resolution->time, resolution->switches->contacts[contact].name);
}

/* Returns the contact whose impulse closes the gap of a row most; the row itself if none does. */
static size_t find_opponent(const struct ContactImpulses *impulses, size_t row) {
  size_t found = row;
  double most = 0.0;
  for (size_t i = 0; i < impulses->contact_count; i++) {
    double delassus = impulses->delassus[row * impulses->count + i];
    if (delassus >= most) continue;
    most = delassus;
    found = i;
  }
  return found;
}

const char *contact_forces_report_crushed(struct Resolution *resolution, size_t contact) {
  const struct SwitchTable *switches = resolution->switches;
  struct ContactImpulses impulses;
  for (size_t i = 0; i < switches->contact_count; i++)
    resolution->part[i] = i == contact || is_touching(resolution, i) ? TAKES_PART : LEFT_OUT;
  for (size_t i = 0; i < switches->friction_count; i++) *part_of_friction(resolution, i) = LEFT_OUT;
  if (!find_contact_impulses(resolution, &impulses)) return no_contact_impulses;
  size_t row = 0;
  while (impulses.member[row] != contact) row++;
  log_message(
      resolution->instance, resolution_status(resolution),
      "time %g: the contacts '%s' and '%s' crush a body between them: prescribed motions, or far larger masses, "
      "close one of them; expected motions that leave room, or a force or a spring in place of one contact",
      resolution->time, switches->contacts[contact].name,
      switches->contacts[impulses.member[find_opponent(&impulses, row)]].name);
  contact_impulses_free(resolution, &impulses);
  return crushed;
}

void free_resting(const struct Resolution *resolution, struct RestingContacts *resting) {
  if (resting->block != NULL) scratch_return(resolution->instance, SCRATCH_RESTING);
  contact_impulses_free(resolution, &resting->impulses);
}

/*
 * Deselects the contacts that cannot move, as those that stick keep their gaps constant. Their forces are not the
 * subject of this problem. Sets *drops if there are any. False if M is singular.
 */
static bool drop_fixed_contacts(struct Resolution *resolution, const struct ContactImpulses *impulses, bool *drops) {
  double *own = scratch_take(resolution->instance, SCRATCH_RESTING, impulses->contact_count * sizeof *own);
  bool done = own != NULL && contact_impulses_find_own(resolution, impulses, own);
  if (own == NULL) solver_is_out_of_memory(resolution->instance);
  *drops = false;
  for (size_t i = 0; i < impulses->contact_count && done; i++) {
    if (impulses->delassus[i * impulses->count + i] > smallest_share_of_motion * own[i]) continue;
    resolution->part[impulses->member[i]] = LEFT_OUT;
    *drops = true;
  }
  if (own != NULL) scratch_return(resolution->instance, SCRATCH_RESTING);
  return done;
}

/* Computes the impulses of the selected contacts that can move. False if M is singular or memory is missing. */
static bool find_movable_contacts(struct Resolution *resolution, struct ContactImpulses *impulses) {
  bool drops;
  if (!find_contact_impulses(resolution, impulses)) return false;
  if (!drop_fixed_contacts(resolution, impulses, &drops)) {
    contact_impulses_free(resolution, impulses);
    return false;
  }
  if (!drops) return true;
  contact_impulses_free(resolution, impulses);
  return find_contact_impulses(resolution, impulses);
}

bool create_resting(struct Resolution *resolution, struct RestingContacts *resting, const char **problem) {
  *resting = (struct RestingContacts){0};
  *problem = NULL;
  if (!find_movable_contacts(resolution, &resting->impulses)) {
    *problem = no_contact_impulses;
    return false;
  }
  const struct ConePath *path = resolution->switches->cone_path;
  size_t n = resting->impulses.contact_count, bytes = resting_forces_bytes(path, n);
  if (n > 0) resting->block = scratch_take(resolution->instance, SCRATCH_RESTING, bytes + n * sizeof(double));
  if (resting->block == NULL) {
    if (n > 0) {
      solver_is_out_of_memory(resolution->instance);
      *problem = no_contact_impulses;
    }
    free_resting(resolution, resting);
    return false;
  }
  resting->unit = resting->block;
  resting->forces = resting_forces_in(resting->unit + n, path, n);
  fill_resting(resolution, resting);
  return true;
}

/*
 * Returns the contact at rest with the largest closing acceleration beyond rounding, such as one opened too early;
 * contact_count if there is none.
 */
static size_t find_sinking(const struct Resolution *resolution, const struct RestingContacts *resting) {
  double free = largest_free_acceleration(&resting->forces), force = largest_contact_force(resolution), most = 0.0;
  size_t found = resolution->switches->contact_count;
  for (size_t i = 0; i < resting->forces.count; i++) {
    size_t contact = resting->impulses.member[i];
    double acceleration = contact_value(resolution, contact, CONTACT_ACCELERATION);
    double share = resolution->forced[contact] == FORCED_OPEN ? uncertain_acceleration : rounded_acceleration;
    double unit = resting->unit[i], rounding = share * fmax(free / unit, force / (unit * unit));
    if (!sinks(resolution, contact) || !(acceleration < -rounding) || acceleration >= most) continue;
    most = acceleration;
    found = contact;
  }
  return found;
}

/* Lets frictions in planes on a contact that closes slide: they may have lost their force as the contact opened. */
static void let_slide(struct Resolution *resolution, size_t contact) {
  for (size_t i = 0; i < resolution->switches->friction_count; i++)
    if (is_in_plane(resolution->switches, i) && rests_on(resolution->switches, i, contact))
      set_friction(resolution, i, 1.0);
}

/*
 * Opens and closes the contacts according to the solution. Where is_least, no other contacts are closed than those that
 * press: with any other one, the forces of least norm might pull. True if any changes.
 */
static bool take_solution(struct Resolution *resolution, const struct RestingContacts *resting, bool is_least) {
  bool changes = false;
  const struct RestingForces *forces = &resting->forces;
  double rounding = rounded_force * largest_free_acceleration(forces);
  for (size_t i = 0; i < forces->count; i++) {
    size_t contact = resting->impulses.member[i];
    bool is_closed = contact_is_closed(resolution, contact);
    bool presses = forces->found_force[i] > rounding, parts = forces->found[i] > rounding;
    if (is_closed == (is_closed && !is_least ? !parts : presses)) continue;
    set_contact(resolution, contact, !is_closed);
    if (!is_closed) let_slide(resolution, contact);
    resolution->forced[contact] = is_closed ? FORCED_OPEN : FORCED_CLOSED;
    changes = true;
  }
  return changes;
}

const char *contact_forces_resolve(struct Resolution *resolution, bool *again) {
  const struct SlidingLaws *laws = resolution->switches->sliding_laws; /* not NULL if frictions slide */
  struct RestingContacts resting;
  struct Paradox paradox = {.contact = NULL};
  *again = false;
  const char *problem;
  bool slides = choose_resting(resolution);
  bool is_examined = slides && resolution->occasion == AT_START && !laws->any_begins(resolution);
  if (!is_examined && !any_sinks(resolution, slides)) return NULL;
  if (!create_resting(resolution, &resting, &problem)) return problem;
  slides &= resting.impulses.friction_count > 0;
  size_t sinking = find_sinking(resolution, &resting);
  bool closes = sinking < resolution->switches->contact_count;
  if (slides && (closes || is_examined)) resting.solutions = resting_forces_solve(&resting.forces, !closes);
  bool is_crushed = !slides && closes && !resting_forces_press(&resting.forces, resting.unit);
  bool changes = closes || resting.solutions == OTHER_MOTION;
  if (resting.solutions == NO_MOTION) laws->find_paradox(resolution, &resting, &paradox);
  else if (changes && !is_crushed) *again = take_solution(resolution, &resting, !slides);
  if (resting.solutions == PERHAPS_OTHERS || resting.solutions == OTHER_MOTION)
    laws->report_others(resolution, &resting);
  free_resting(resolution, &resting);
  if (paradox.contact != NULL) return laws->resolve_paradox(resolution, &paradox, again);
  /* Frictions that stick may close a contact: they slip. */
  *again |= is_crushed && laws != NULL && laws->find_all_forces(resolution);
  return is_crushed && !*again ? contact_forces_report_crushed(resolution, sinking) : NULL;
}
