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
 * The problem is set up after the frictions have their modes. It is needed if a friction slides on a contact at
 * rest, or if a contact that its force has opened would close again. If no open contact approaches, the present
 * forces are a solution, and only their uniqueness is examined (resting_forces.c). It is not examined while a
 * friction begins to slide, since its direction would differ in another solution. If an open contact approaches, the
 * solution found sets the contacts. If there is none, or more than one, or existence is unknown, the motion ends with
 * a message.
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

/* Contacts jam if friction reduces their diagonal element of S to less than this fraction of that of W. */
static const double jamming_share = 1e-3;

/*
 * A contact cannot move if the held contacts and frictions leave less than this fraction of its W_ii. It is the squared
 * sine of the angle between them. Where the contact follows from them, it is rounding.
 */
static const double smallest_share_of_motion = 1e-10;

/* Number of solutions, as messages say it; NULL if the motion continues. */
static const char *const numbers_of_solutions[] = {
    [SEVERAL_MOTIONS] = "more than one", [PERHAPS_NONE] = "perhaps no", [NO_MOTION] = "no"};

static const char crushed[] = "contacts crush a body between them";
static const char no_contact_impulses[] = "the forces of contacts cannot be found";

/* The problem of the contacts that take part; forces are in units of unit[]. */
struct RestingContacts {
  struct ContactImpulses impulses;
  struct RestingForces forces;
  double *unit; /* unit of the force of each contact: 1 / sqrt(W_ii) */
  void *block;
};

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

/* True if a contact that its force has opened in this event accelerates towards closing. */
static bool any_comes_back(const struct Resolution *resolution) {
  bool any = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    any |= resolution->forced[i] == FORCED_OPEN && resolution->part[i] != LEFT_OUT &&
           !contact_is_closed(resolution, i) &&
           contact_value(resolution, i, CONTACT_ACCELERATION) < -error_bound_of_acceleration(resolution, i);
  return any;
}

/*
 * Lets the contacts at rest without sticking friction and the frictions that slide take part. True if a
 * selected friction rests on a selected contact.
 */
static bool choose_resting(struct Resolution *resolution) {
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
  forces->lasts = resolution->occasion != AT_START;
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

static void log_crushed(const struct Resolution *resolution, const struct ContactImpulses *impulses, size_t contact) {
  const struct ContactMetadata *contacts = resolution->switches->contacts;
  size_t row = 0;
  while (impulses->member[row] != contact) row++;
  log_message(
      resolution->instance, resolution_status(resolution),
      "time %g: the contacts '%s' and '%s' crush a body between them: prescribed motions, or far larger masses, "
      "close one of them; expected motions that leave room, or a force or a spring in place of one contact",
      resolution->time, contacts[contact].name, contacts[impulses->member[find_opponent(impulses, row)]].name);
}

const char *contact_forces_report_crushed(struct Resolution *resolution, size_t contact) {
  const struct SwitchTable *switches = resolution->switches;
  struct ContactImpulses impulses;
  for (size_t i = 0; i < switches->contact_count; i++)
    resolution->part[i] = i == contact || is_touching(resolution, i) ? TAKES_PART : LEFT_OUT;
  for (size_t i = 0; i < switches->friction_count; i++) *part_of_friction(resolution, i) = LEFT_OUT;
  if (!find_contact_impulses(resolution, &impulses)) return no_contact_impulses;
  log_crushed(resolution, &impulses, contact);
  contact_impulses_free(resolution, &impulses);
  return crushed;
}

static void free_resting(const struct Resolution *resolution, struct RestingContacts *resting) {
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

/*
 * Sets up the problem. False, with *problem NULL, if no selected contact can move; with the reason, if M is singular or
 * memory is missing.
 */
static bool create_resting(struct Resolution *resolution, struct RestingContacts *resting, const char **problem) {
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
 * Returns the open contact at rest with the largest closing acceleration beyond rounding, such as one opened too early;
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
    double least = error_bound_of_acceleration(resolution, contact) + rounding;
    if (contact_is_closed(resolution, contact) || !(acceleration < -least) || acceleration >= most) continue;
    most = acceleration;
    found = contact;
  }
  return found;
}

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

/* The names and the number in a message about missing forces. */
struct Paradox {
  const char *contact, *friction, *how_many; /* how_many solutions there are */
};

static struct Paradox find_paradox(const struct Resolution *resolution, const struct RestingContacts *resting,
                                   const char *how_many) {
  size_t row = find_locked(resting);
  return (struct Paradox){.contact = resolution->switches->contacts[resting->impulses.member[row]].name,
                          .friction = locking_friction(resolution, &resting->impulses, row),
                          .how_many = how_many};
}

/*
 * Finds the forces of frictions in planes at rest too, without which those of the contacts do not exist. Sets *again if
 * that sets the modes. Else it logs the paradox, and returns the reason to stop.
 */
static const char *resolve_together(struct Resolution *resolution, const struct Paradox *paradox, bool *again) {
  const struct FrictionLaws *laws = resolution->switches->friction_laws;
  *again = laws->resolve_together != NULL && laws->resolve_together(resolution);
  if (*again) return NULL;
  log_message(resolution->instance, resolution_status(resolution),
              "time %g: the force of the contact '%s' has %s solution, as the friction '%s' slides and presses it "
              "together (Painleve's paradox); expected less friction, or another position",
              resolution->time, paradox->contact, paradox->how_many, paradox->friction);
  return "forces of contacts with friction are not determined";
}

/* Lets frictions in planes on a contact that closes slide: they may have lost their force as the contact opened. */
static void let_slide(struct Resolution *resolution, size_t contact) {
  for (size_t i = 0; i < resolution->switches->friction_count; i++)
    if (is_in_plane(resolution->switches, i) && rests_on(resolution->switches, i, contact))
      set_friction(resolution, i, 1.0);
}

/* Opens and closes the contacts according to the solution. True if any changes. */
static bool take_solution(struct Resolution *resolution, const struct RestingContacts *resting) {
  bool changes = false;
  const struct RestingForces *forces = &resting->forces;
  double rounding = rounded_force * largest_free_acceleration(forces);
  for (size_t i = 0; i < forces->count; i++) {
    size_t contact = resting->impulses.member[i];
    bool is_closed = contact_is_closed(resolution, contact);
    bool presses = forces->found_force[i] > rounding, parts = forces->found[i] > rounding;
    if (is_closed ? !parts : !presses) continue;
    set_contact(resolution, contact, !is_closed);
    if (!is_closed) let_slide(resolution, contact);
    resolution->forced[contact] = is_closed ? FORCED_OPEN : FORCED_CLOSED;
    changes = true;
  }
  return changes;
}

/* Warns at most once an instance that the solution may not be unique. */
static void report_others(const struct Resolution *resolution, const struct RestingContacts *resting) {
  const struct ContactImpulses *impulses = &resting->impulses;
  size_t contact = find_locked(resting);
  if (resolution->instance->reported_other_forces) return;
  resolution->instance->reported_other_forces = true;
  log_message(resolution->instance, STATUS_WARNING,
              "time %g: the forces of sliding contacts, such as '%s' with the friction '%s', may have another "
              "solution: too many contacts are coupled to exclude it",
              resolution->time, resolution->switches->contacts[impulses->member[contact]].name,
              locking_friction(resolution, impulses, contact));
}

/*
 * True if a friction on a selected contact begins to slide: it is at rest, and its direction follows from its
 * acceleration. With other contacts closed it would slide in another direction, so that forces at this direction say
 * nothing about other solutions.
 */
static bool any_begins_to_slide(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  double slowest = tolerances_of(resolution).rest;
  bool begins = false;
  for (size_t i = 0; i < switches->friction_count; i++) {
    if (friction_sticks(resolution, i) || !(sliding_speed(resolution, i) <= slowest)) continue;
    for (size_t k = 0; k < switches->contact_count; k++)
      begins |= resolution->part[k] != LEFT_OUT && rests_on(switches, i, k);
  }
  return begins;
}

const char *contact_forces_resolve(struct Resolution *resolution, bool *again) {
  struct RestingContacts resting;
  struct Paradox paradox = {.how_many = NULL};
  *again = false;
  const char *problem = NULL;
  bool slides = choose_resting(resolution);
  if (!slides && !any_comes_back(resolution)) return NULL;
  bool is_unclear = any_begins_to_slide(resolution);
  if (!create_resting(resolution, &resting, &problem)) return problem;
  slides &= resting.impulses.friction_count > 0;
  size_t sinking = find_sinking(resolution, &resting);
  bool closes = sinking < resolution->switches->contact_count;
  enum RestingSolutions solutions = ONE_MOTION;
  if (slides && (closes || !is_unclear)) solutions = resting_forces_solve(&resting.forces, !closes);
  if (!slides && closes && !resting_forces_press(&resting.forces)) {
    log_crushed(resolution, &resting.impulses, sinking);
    problem = crushed;
  } else if (numbers_of_solutions[solutions] != NULL)
    paradox = find_paradox(resolution, &resting, numbers_of_solutions[solutions]);
  else if (closes) *again = take_solution(resolution, &resting);
  if (solutions == PERHAPS_OTHERS) report_others(resolution, &resting);
  free_resting(resolution, &resting);
  return paradox.how_many != NULL ? resolve_together(resolution, &paradox, again) : problem;
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

bool contact_forces_explain(struct Resolution *resolution) {
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
