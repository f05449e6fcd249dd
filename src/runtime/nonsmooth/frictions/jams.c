/*
 * Finds the modes of frictions at rest by enumeration. The friction of a worm gear follows from the size of the
 * tooth force, which follows from the friction. The matrix of this complementarity problem need not be a P-matrix,
 * so that switching one mode after another may cycle (Painleve's paradox). This search is made if they do, once an
 * event resolution. It tries all combinations of the modes in question. Each friction at rest sticks or slides
 * either way; each branch that has switched or depends on forces has either sign. Combinations with equal
 * accelerations are one motion. The search ends at the second motion, and needs one evaluation of the accelerations
 * for each of at most MOST_COMBINATIONS combinations.
 */
#include "nonsmooth/frictions/jams.h"

#include <math.h>
#include <string.h>

#include "nonsmooth/contacts/planes.h"
#include "evaluation/services.h"

/* Combinations that are tried at most: 3^6, those of six frictions. */
enum { MOST_COMBINATIONS = 729 };

/* Accelerations that differ by less than this, relative to the largest, are equal. */
static const double same_share = 1e-9;

/* A search for the motions that are consistent with Coulomb's law. */
struct JamSearch {
  struct Resolution *resolution;
  double *kept;        /* accelerations of the motion that was found, in workspace */
  size_t found;        /* combination of that motion */
  size_t combinations; /* their number */
  int motions;         /* different motions found; 2 for several */
  size_t friction;     /* the last one in question; friction_count for none */
};

/* Returns the sign of the velocity of a friction along a line; 0 at rest within rounding, NAN for other frictions. */
static double direction_of(const struct Resolution *resolution, size_t friction) {
  size_t slot = friction_slot(resolution->switches, friction, FRICTION_VELOCITY);
  double velocity = resolution->value[slot];
  if (resolution->switches->frictions[friction].is_given || is_in_plane(resolution->switches, friction)) return NAN;
  if (!(fabs(velocity) > resolution_error_bound(resolution, slot, slot + FRICTION_RATE))) return 0.0;
  return velocity < 0.0 ? -1.0 : 1.0;
}

/*
 * At the start, where all frictions slide forwards, sets moving frictions to the sign of their velocities. Returns the
 * last one that changed; friction_count for none.
 */
static size_t reverse_moving(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  size_t switched = switches->friction_count;
  for (size_t i = 0; i < switches->friction_count && resolution->occasion == AT_START; i++) {
    double direction = direction_of(resolution, i);
    if (!(direction * mode_of(resolution, switches->frictions[i].mode) < 0.0)) continue;
    set_friction(resolution, i, direction);
    switched = i;
  }
  return switched;
}

static bool is_tried_branch(const struct Resolution *resolution, size_t branch) {
  return !resolution->switches->branches[branch].is_last_sign && resolution->flips[branch] > 0.0;
}

/* Counts a switch of each branch whose indicator depends on forces or accelerations, so that it is tried. */
static void mark_branches(struct Resolution *resolution) {
  double *value = resolution->error_bound; /* recomputed for each combination */
  struct Point point = solver_point(resolution->instance, resolution->time, resolution->state);
  resolution_values_of_force(resolution, &point, lagrangian.constraints.count, 0.0, value);
  for (size_t i = 0; i < resolution->switches->branch_count; i++)
    if (value[i] != resolution->value[i]) resolution->flips[i] = fmax(resolution->flips[i], 1.0);
}

/*
 * Counts the combinations, and lets the frictions in question take part. False if there are too many combinations,
 * or no friction is in question.
 */
static bool begin_search(struct JamSearch *search) {
  struct Resolution *resolution = search->resolution;
  const struct SwitchTable *switches = resolution->switches;
  search->combinations = 1;
  search->friction = reverse_moving(resolution);
  for (size_t i = 0; i < switches->friction_count; i++) {
    bool is_tried = direction_of(resolution, i) == 0.0;
    *part_of_friction(resolution, i) = is_tried ? TAKES_PART : LEFT_OUT;
    if (!is_tried) continue;
    search->friction = i;
    search->combinations *= 3;
    if (search->combinations > MOST_COMBINATIONS) return false;
  }
  mark_branches(resolution);
  for (size_t i = 0; i < switches->branch_count; i++) {
    if (is_tried_branch(resolution, i)) search->combinations *= 2;
    if (search->combinations > MOST_COMBINATIONS) return false;
  }
  return search->friction < switches->friction_count;
}

/* Sets the modes of a combination: its digits, base 3 for frictions, then base 2 for branches. */
static void set_combination(struct Resolution *resolution, size_t combination) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->friction_count; i++) {
    if (*part_of_friction(resolution, i) == LEFT_OUT) continue;
    set_friction(resolution, i, (double)(combination % 3) - 1.0);
    combination /= 3;
  }
  for (size_t i = 0; i < switches->branch_count; i++) {
    if (!is_tried_branch(resolution, i)) continue;
    resolution_set_mode(resolution, switches->branches[i].mode, combination % 2 == 0 ? -1.0 : 1.0);
    combination /= 2;
  }
}

static bool friction_agrees(const struct Resolution *resolution, size_t friction) {
  const double *value = &resolution->value[friction_slot(resolution->switches, friction, 0)];
  const double *error_bound = &resolution->error_bound[friction_slot(resolution->switches, friction, 0)];
  const struct FrictionMetadata *metadata = &resolution->switches->frictions[friction];
  double mode = mode_of(resolution, metadata->mode), rounding = resolution->force_error_bound[friction];
  double force = force_on_line(resolution, friction);
  if (mode != 0.0) return mode * value[FRICTION_RATE] > error_bound[FRICTION_RATE];
  return force <= value[FRICTION_STICTION] + error_bound[FRICTION_STICTION] + rounding &&
         -force <= value[FRICTION_STICTION_BACK] + error_bound[FRICTION_STICTION_BACK] + rounding;
}

/* True if accelerations and forces agree with the modes. */
static bool combination_agrees(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  bool agrees = resolution_evaluate(resolution);
  for (size_t i = 0; i < switches->branch_count && agrees; i++)
    agrees = !is_tried_branch(resolution, i) ||
             mode_of(resolution, switches->branches[i].mode) * resolution->value[i] >= -resolution->error_bound[i];
  for (size_t i = 0; i < switches->friction_count && agrees; i++)
    agrees = *part_of_friction(resolution, i) == LEFT_OUT || friction_agrees(resolution, i);
  return agrees;
}

/* Records a combination that agrees, unless its motion is the one that was found before. */
static void take_motion(struct JamSearch *search, size_t combination) {
  const double *present = search->resolution->acceleration;
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
  const struct Resolution *resolution = search->resolution;
  log_message(resolution->instance, resolution_status(resolution),
              "time %g: the friction '%s', whose force follows from constraint forces, can stick or slide in more than "
              "one way (Painleve's paradox); expected less friction, or another load",
              resolution->time, resolution->switches->frictions[search->friction].name);
}

/*
 * Sets the switch counters of the modes that were tried to 1: later rounds treat these modes as chosen in this event.
 */
static void count_frictions(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  for (size_t i = 0; i < switches->friction_count; i++)
    if (*part_of_friction(resolution, i) != LEFT_OUT) resolution->flips[friction_indicator(switches, i)] = 1.0;
  for (size_t i = 0; i < switches->branch_count; i++)
    if (is_tried_branch(resolution, i)) resolution->flips[i] = 1.0;
}

bool jams_resolve(struct Resolution *resolution) {
  struct JamSearch search = {.resolution = resolution, .kept = resolution->correction};
  if (resolution->has_searched_jam || !resolution->switches->feels_forces) return false;
  resolution->has_searched_jam = true;
  if (!begin_search(&search)) return false;
  resolution_keep_modes(resolution);
  for (size_t i = 0; i < search.combinations && search.motions < 2; i++) {
    set_combination(resolution, i);
    if (combination_agrees(resolution)) take_motion(&search, i);
  }
  resolution_restore_modes(resolution);
  resolution->instance->singular = 0;
  resolution->has_several_motions = search.motions > 1;
  if (search.motions > 1) log_several(&search);
  if (search.motions != 1) return false;
  set_combination(resolution, search.found);
  count_frictions(resolution);
  return true;
}
