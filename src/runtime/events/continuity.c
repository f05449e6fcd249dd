#include "events/continuity.h"

#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "instance/projection.h"

/* In units of the scales of the state: less of a change may be rounding. */
static const double least_kink = 1e-6;

const char constraints_not_kept[] = "the constraints cannot be kept at an event";

const char *continuity_begin(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  bool can_matter = switches->branch_count > 0 || switches->assignment_count > 0;
  if (lagrangian.constraints.projection == NULL || !can_matter) return NULL;
  if (evaluate_prepare(settlement->instance) != STATUS_DONE) return constraints_not_kept;
  double moved = lagrangian.constraints.projection->project(settlement->instance, settlement->time, settlement->state);
  return isfinite(moved) ? NULL : constraints_not_kept;
}

void continuity_note(struct Settlement *settlement, size_t branch) {
  const struct SwitchTable *switches = settlement->switches;
  const struct BranchFacts *facts = &switches->branches[branch];
  double rate = settlement->value[branch_rate_place(switches, branch)];
  if (settlement->switched == NULL) {
    settlement->switched = facts;
    settlement->overshoot = rate != 0.0 ? fabs(settlement->value[branch] / rate) : 0.0;
  }
  if (!facts->holds_energy || settlement->energetic != NULL) return;
  settlement->energetic = facts;
  memcpy(settlement->energy, settlement->value + energy_place(switches), switches->energy_count * sizeof(double));
}

double continuity_allowed_share(const struct Settlement *settlement) {
  double change = 0.0;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) {
    size_t velocity = lagrangian.coordinate_count + i;
    change = fmax(change, fabs(settlement->acceleration[i]) / scale_of(settlement->state, velocity));
  }
  return least_kink + 4.0 * settlement->overshoot * change;
}

/* The largest jump among so many energies or momenta, of those from first on, as a share of their size. */
static double share_of_jump(const struct Settlement *settlement, size_t first, size_t count) {
  size_t place = energy_place(settlement->switches) + first;
  const double *before = settlement->energy + first, *behind = settlement->value + place;
  const double *noise = settlement->noise + place;
  double size = 0.0, jump = 0.0;
  for (size_t i = 0; i < count; i++) size = fmax(size, fmax(fabs(before[i]), fabs(behind[i])));
  for (size_t i = 0; i < count; i++)
    if (fabs(behind[i] - before[i]) > 8.0 * noise[i]) jump = fmax(jump, fabs(behind[i] - before[i]) / size);
  return jump;
}

/*
 * Where an energy or a momentum jumps as the motion comes to a place, the velocities would have to jump with it, by a law
 * that the system does not tell.
 */
static const char *check_energy(const struct Settlement *settlement) {
  bool by_events = settlement->jumped || settlement->set_mode || settlement->occasion == AT_CHANGE;
  if (settlement->energetic == NULL || by_events || settlement->occasion == AT_START) return NULL;
  size_t count = settlement->switches->energy_count;
  double jump = fmax(share_of_jump(settlement, 0, 2), share_of_jump(settlement, 2, count - 2));
  if (!(jump > continuity_allowed_share(settlement))) return NULL;
  log_message(settlement->instance, settlement->occasion == IN_EXCHANGE ? STATUS_ERROR : STATUS_DISCARD,
              "time %g: %s, line %ld of %s, jumps there in an energy or a position, by a share of %.2g, for which no "
              "velocity tells its part; expected energies without jumps, or an <event> that sets the velocities",
              settlement->time, settlement->energetic->function, settlement->energetic->line,
              settlement->energetic->file, jump);
  return "an energy jumps";
}

/* Whether the constraints hold as before in the branches that were switched to. */
static const char *check_constraints(struct Settlement *settlement) {
  struct Instance *instance = settlement->instance;
  bool may_turn = may_turn_gaps(settlement) && !settlement->jumped;
  if (lagrangian.constraints.projection == NULL || !(may_turn || settlement->moved)) return NULL;
  if (evaluate_prepare(instance) != STATUS_DONE) return constraints_not_kept;
  bool starts = settlement->occasion == AT_START;
  double moved = starts ? lagrangian.constraints.projection->drift(instance, settlement->time)
                        : lagrangian.constraints.projection->project(instance, settlement->time, settlement->state);
  if (moved <= continuity_allowed_share(settlement)) return NULL;
  enum Status status = starts || settlement->occasion == IN_EXCHANGE ? STATUS_ERROR : STATUS_DISCARD;
  if (settlement->set_mode || settlement->moved)
    log_message(instance, status,
                "time %g: an event sets %s so that the constraints do not hold; expected values of <set> for all "
                "coordinates and velocities that they move, which fulfil them",
                settlement->time, settlement->moved ? "coordinates" : "modes");
  else
    log_message(
        instance, status,
        "time %g: %s, line %ld of %s, turns or jumps there in a constraint, or in the gap of a closed "
        "contact, and positions or velocities would have to jump with it; expected one without kinks, or a <contact> "
        "for each piece of a gap",
        settlement->time, settlement->switched->function, settlement->switched->line, settlement->switched->file);
  return constraints_not_kept;
}

const char *continuity_check(struct Settlement *settlement) {
  const char *problem = check_energy(settlement);
  return problem == NULL ? check_constraints(settlement) : problem;
}
