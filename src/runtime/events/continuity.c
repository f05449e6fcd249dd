#include "events/continuity.h"

#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "instance/projection.h"

/* In units of the scales of the state: a smaller change may be a rounding error. */
static const double least_kink = 1e-6;

const double crowding_share = 1e-6;

/* Events at a corner that follow one another within this share of the time, before they count as Zeno behaviour. */
enum { CORNER_LIMIT = 30 };

const char constraints_not_kept[] = "the constraints cannot be fulfilled after an event";
const char touched_corner[] = "both sides of the corner of a gap touch";

const char *continuity_begin(struct Settlement *settlement) {
  const struct SwitchTable *switches = settlement->switches;
  bool can_matter = switches->branch_count > 0 || switches->assignment_count > 0;
  if (lagrangian.constraints.projection == NULL || !can_matter) return NULL;
  if (evaluate_prepare(settlement->instance) != STATUS_DONE) return constraints_not_kept;
  const struct Projection *laws = lagrangian.constraints.projection;
  double moved = laws->project(settlement->instance, settlement->time, settlement->state);
  if (isfinite(moved)) return NULL;
  log_unkept(settlement->instance, settlement->occasion == IN_EXCHANGE ? STATUS_ERROR : STATUS_DISCARD,
             settlement->time, laws->unkept(settlement->instance, settlement->time));
  return constraints_not_kept;
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

/* Returns the largest jump among count energies or momenta from first on, relative to their size. */
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

/* Logs an energy or momentum that jumps: nothing determines how the velocities would have to jump with it. */
static const char *check_energy(const struct Settlement *settlement) {
  bool by_events = settlement->jumped || settlement->set_mode || settlement->occasion == AT_CHANGE;
  if (settlement->energetic == NULL || by_events || settlement->occasion == AT_START) return NULL;
  size_t count = settlement->switches->energy_count;
  double jump = fmax(share_of_jump(settlement, 0, 2), share_of_jump(settlement, 2, count - 2));
  if (!(jump > continuity_allowed_share(settlement))) return NULL;
  log_message(settlement->instance, settlement->occasion == IN_EXCHANGE ? STATUS_ERROR : STATUS_DISCARD,
              "time %g: %s, line %ld of %s, makes an energy or a position jump by a fraction of %.2g, which determines "
              "no velocities; expected energies without jumps, or an <event> that sets the velocities",
              settlement->time, settlement->energetic->function, settlement->energetic->line,
              settlement->energetic->file, jump);
  return "an energy jumps";
}

/* Evaluates value[] for one piece of a branch, at arbitrary velocities, at which pieces of gaps differ. */
static bool values_of_piece(struct Settlement *settlement, size_t branch, double piece, double *value) {
  struct Instance *instance = settlement->instance;
  size_t n = lagrangian.coordinate_count;
  instance->parameter[settlement->switches->branches[branch].mode] = piece;
  instance->prepared_is_stale = true;
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  memcpy(settlement->rounded, settlement->state, lagrangian.state_count * sizeof *settlement->rounded);
  for (size_t i = 0; i < n; i++) settlement->rounded[n + i] = 1.0 / (1.0 + (double)i);
  struct Point point = solver_point(instance, settlement->time, settlement->rounded);
  settlement_values_of_force(settlement, &point, lagrangian.constraints.count, 0.0, value);
  return true;
}

/* Returns the contact whose gap differs between the pieces of a branch; contact_count for none. */
static size_t find_corner(struct Settlement *settlement, size_t branch) {
  const struct SwitchTable *switches = settlement->switches;
  const double *one = settlement->value, *other = settlement->other_noise;
  size_t mode = switches->branches[branch].mode, found = 0;
  double kept = mode_of(settlement, mode);
  bool is_known = values_of_piece(settlement, branch, 1.0, settlement->value) &&
                  values_of_piece(settlement, branch, -1.0, settlement->other_noise);
  settlement->instance->parameter[mode] = kept;
  settlement->instance->prepared_is_stale = true;
  while (is_known && found < switches->contact_count &&
         one[contact_place(switches, found, CONTACT_RATE)] == other[contact_place(switches, found, CONTACT_RATE)])
    found++;
  return is_known ? found : switches->contact_count;
}

bool continuity_explain_corner(struct Settlement *settlement, size_t branch) {
  const struct BranchFacts *facts = &settlement->switches->branches[branch];
  size_t contact = find_corner(settlement, branch);
  if (contact == settlement->switches->contact_count) return false;
  bool is_discarded = settlement->occasion == AT_EVENT || settlement->occasion == AT_CHANGE;
  log_message(settlement->instance, is_discarded ? STATUS_DISCARD : STATUS_ERROR,
              "time %g: the gap of the contact '%s' has a corner, by %s, line %ld of %s, and both of its pieces touch; "
              "expected a <contact> for each piece",
              settlement->time, settlement->switches->contacts[contact].name, facts->function, facts->line,
              facts->file);
  return true;
}

const char *continuity_check_corner(struct Settlement *settlement) {
  struct Situation *situation = settlement->instance->situation;
  if (settlement->occasion != IN_EXCHANGE || settlement->switched == NULL) return NULL;
  bool is_crowded = settlement->time - situation->switched <= crowding_share * fabs(settlement->time);
  situation->gathered = is_crowded ? situation->gathered + 1 : 0;
  situation->switched = settlement->time;
  if (situation->gathered < CORNER_LIMIT) return NULL;
  situation->gathered = 0;
  size_t branch = (size_t)(settlement->switched - settlement->switches->branches);
  return continuity_explain_corner(settlement, branch) ? touched_corner : NULL;
}

/* Checks that the constraints hold after branches have switched. Returns NULL, or the reason. */
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
  size_t unkept = lagrangian.constraints.projection->unkept(instance, settlement->time);
  const char *name = lagrangian.constraints.names[unkept];
  if (settlement->set_mode || settlement->moved)
    log_message(instance, status,
                "time %g: an event sets %s that violate the %s '%s'; expected a <set> of all its coordinates and "
                "velocities, with values that fulfil it",
                settlement->time, settlement->moved ? "coordinates" : "modes", evaluate_kind(unkept), name);
  else if (!continuity_explain_corner(settlement, (size_t)(settlement->switched - settlement->switches->branches)))
    log_message(instance, status,
                "time %g: %s, line %ld of %s, has a kink or jump in the %s '%s', so that positions or velocities would "
                "have to jump; expected one without kinks",
                settlement->time, settlement->switched->function, settlement->switched->line,
                settlement->switched->file, evaluate_kind(unkept), name);
  return constraints_not_kept;
}

const char *continuity_check(struct Settlement *settlement) {
  const char *problem = check_energy(settlement);
  return problem == NULL ? check_constraints(settlement) : problem;
}
