/*
 * The friction of a worm follows from the size of the force of its gear, which follows from the friction: a complementarity
 * problem whose matrix need not be a P-matrix, so that switching one mode after another may go round without end (Painleve's
 * paradox). All combinations of the modes in question are tried: each friction at rest sticks or slides either way, each branch
 * has either sign. Combinations with the same accelerations are one motion.
 */
#include "contacts/jams.h"

#include <math.h>
#include <string.h>

#include "contacts/planes.h"
#include "contacts/pushes.h"
#include "evaluation/services.h"

enum { MOST_COMBINATIONS = 729 };

/* Accelerations that differ by less of the largest are the same. */
static const double same_share = 1e-9;

struct JamSearch {
  struct Settlement *settlement;
  double *kept;        /* the accelerations of the motion that was found, in workspace */
  size_t found;        /* the combination of that motion */
  size_t combinations; /* how many there are */
  int motions;         /* how many different ones were found: 2 for several */
  size_t friction;     /* the last one in question; friction_count for none */
};

/* The direction in which a friction along a line moves, by more than rounding; 0 of one at rest, NAN of others. */
static double direction_of(const struct Settlement *settlement, size_t friction) {
  size_t place = friction_place(settlement->switches, friction, FRICTION_VELOCITY);
  double velocity = settlement->value[place];
  if (settlement->switches->frictions[friction].is_given || is_in_plane(settlement->switches, friction)) return NAN;
  if (!(fabs(velocity) > settlement_noise(settlement, place, place + FRICTION_RATE))) return 0.0;
  return velocity < 0.0 ? -1.0 : 1.0;
}

/* Before the start all slide forwards: lets those that move slide as they do. The last of them; friction_count for none. */
static size_t turn_moving(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  size_t turned = switches->friction_count;
  for (size_t i = 0; i < switches->friction_count && settlement->occasion == AT_START; i++) {
    double direction = direction_of(settlement, i);
    if (!(direction * mode_of(settlement, switches->frictions[i].mode) < 0.0)) continue;
    settlement_set_mode(settlement, switches->frictions[i].mode, direction);
    turned = i;
  }
  return turned;
}

static bool is_tried_branch(const struct Settlement *settlement, size_t branch) {
  return !settlement->switches->branches[branch].is_side && settlement->flips[branch] > 0.0;
}

/* Marks the branches that forces or accelerations decide on, which need not have switched yet. */
static void mark_branches(struct Settlement *settlement) {
  double *value = settlement->noise; /* found anew with each combination */
  struct Point point = solver_point(settlement->instance, settlement->time, settlement->state);
  settlement_values_of_force(settlement, &point, lagrangian.constraints.count, 0.0, value);
  for (size_t i = 0; i < settlement->switches->branch_count; i++)
    if (value[i] != settlement->value[i]) settlement->flips[i] = fmax(settlement->flips[i], 1.0);
}

/* Counts the combinations, and marks the frictions in takes_part. False where there are too many, or no friction is in question. */
static bool begin_search(struct JamSearch *search) {
  struct Settlement *settlement = search->settlement;
  const struct SwitchTable *switches = settlement->switches;
  search->combinations = 1;
  search->friction = turn_moving(settlement);
  for (size_t i = 0; i < switches->friction_count; i++) {
    bool is_tried = direction_of(settlement, i) == 0.0;
    settlement->takes_part[switches->contact_count + i] = is_tried ? 1.0 : 0.0;
    if (!is_tried) continue;
    search->friction = i;
    search->combinations *= 3;
    if (search->combinations > MOST_COMBINATIONS) return false;
  }
  mark_branches(settlement);
  for (size_t i = 0; i < switches->branch_count; i++) {
    if (is_tried_branch(settlement, i)) search->combinations *= 2;
    if (search->combinations > MOST_COMBINATIONS) return false;
  }
  return search->friction < switches->friction_count;
}

/* Sets the modes of a combination, whose digits they are. */
static void set_combination(struct Settlement *settlement, size_t combination) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->friction_count; i++) {
    if (settlement->takes_part[switches->contact_count + i] == 0.0) continue;
    settlement_set_mode(settlement, switches->frictions[i].mode, (double)(combination % 3) - 1.0);
    combination /= 3;
  }
  for (size_t i = 0; i < switches->branch_count; i++) {
    if (!is_tried_branch(settlement, i)) continue;
    settlement_set_mode(settlement, switches->branches[i].mode, combination % 2 == 0 ? -1.0 : 1.0);
    combination /= 2;
  }
}

static bool friction_agrees(const struct Settlement *settlement, size_t friction) {
  const double *value = &settlement->value[friction_place(settlement->switches, friction, 0)];
  const double *noise = &settlement->noise[friction_place(settlement->switches, friction, 0)];
  const struct FrictionFacts *facts = &settlement->switches->frictions[friction];
  double mode = mode_of(settlement, facts->mode), rounding = settlement->force_noise[friction];
  double force = settlement->acceleration[lagrangian.coordinate_count + facts->constraint];
  if (mode != 0.0) return mode * value[FRICTION_RATE] > noise[FRICTION_RATE];
  return force <= value[FRICTION_STICTION] + noise[FRICTION_STICTION] + rounding &&
         -force <= value[FRICTION_STICTION_BACK] + noise[FRICTION_STICTION_BACK] + rounding;
}

/* True if accelerations and forces are what the modes say. */
static bool combination_agrees(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  bool agrees = settlement_evaluate(settlement);
  for (size_t i = 0; i < switches->branch_count && agrees; i++)
    agrees = !is_tried_branch(settlement, i) ||
             mode_of(settlement, switches->branches[i].mode) * settlement->value[i] >= -settlement->noise[i];
  for (size_t i = 0; i < switches->friction_count && agrees; i++)
    agrees = settlement->takes_part[switches->contact_count + i] == 0.0 || friction_agrees(settlement, i);
  return agrees;
}

/* Takes a combination that agrees into the search. */
static void take_motion(struct JamSearch *search, size_t combination) {
  const double *present = search->settlement->acceleration;
  double largest = 0.0, difference = 0.0;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) {
    largest = fmax(largest, fmax(fabs(present[i]), fabs(search->kept[i])));
    difference = fmax(difference, fabs(present[i] - search->kept[i]));
  }
  if (search->motions > 0 && difference <= same_share * largest) return;
  search->motions++;
  search->found = combination;
  memcpy(search->kept, present, lagrangian.coordinate_count * sizeof *present);
}

static void log_several(const struct JamSearch *search) {
  const struct Settlement *settlement = search->settlement;
  log_message(settlement->instance, settlement_status(settlement),
              "time %g: the friction '%s', whose force follows from constraint forces, can stick or slide in more than "
              "one way (Painleve's paradox); expected less friction, or another load",
              settlement->time, settlement->switches->frictions[search->friction].name);
}

/* Rounds that follow take what was found as their own. */
static void count_frictions(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  for (size_t i = 0; i < switches->friction_count; i++)
    if (settlement->takes_part[switches->contact_count + i] != 0.0)
      settlement->flips[friction_indicator(switches, i)] = 1.0;
  for (size_t i = 0; i < switches->branch_count; i++)
    if (is_tried_branch(settlement, i)) settlement->flips[i] = 1.0;
}

bool jams_resolve(struct Settlement *settlement) {
  struct JamSearch search = {.settlement = settlement, .kept = settlement->correction};
  if (settlement->has_searched_jam || !settlement->switches->feels_forces) return false;
  settlement->has_searched_jam = true;
  if (!begin_search(&search)) return false;
  settlement_keep_modes(settlement);
  for (size_t i = 0; i < search.combinations && search.motions < 2; i++) {
    set_combination(settlement, i);
    if (combination_agrees(settlement)) take_motion(&search, i);
  }
  settlement_restore_modes(settlement);
  settlement->instance->singular = 0;
  settlement->has_several_motions = search.motions > 1;
  if (search.motions > 1) log_several(&search);
  if (search.motions != 1) return false;
  set_combination(settlement, search.found);
  count_frictions(settlement);
  return true;
}
