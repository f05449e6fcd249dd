#include "nonsmooth/continuity.h"

#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "instance/active_constraints.h"
#include "instance/projection.h"

/* Changes below this share of the scales of the state may be rounding errors. */
static const double least_kink = 1e-6;

const double close_share = 1e-6;

/*
 * Events at a corner, each within close_share of the time after the last one, before they count as Zeno behaviour.
 */
enum { CORNER_LIMIT = 30 };

const char constraints_not_kept[] = "the constraints cannot be fulfilled after an event";
const char touched_corner[] = "both sides of the corner of a gap touch";

/* Lets frictions slide to which an importer's step has given a velocity against their constraints. */
static bool release_moved(struct Resolution *resolution) {
  const struct FrictionLaws *laws = resolution->switches->friction_laws;
  if (resolution->occasion != IN_EXCHANGE || laws == NULL) return false;
  struct Point point = solver_point(resolution->instance, resolution->time, resolution->state);
  resolution_values_of_force(resolution, &point, lagrangian.constraints.count, 0.0, resolution->value);
  laws->release(resolution);
  return evaluate_prepare(resolution->instance) == STATUS_DONE;
}

/* True if a friction that sticks has reached its limit. It may creep within the solver's error, against its slip. */
static bool friction_yields(const struct Resolution *resolution) {
  size_t first = friction_indicator(resolution->switches, 0);
  return resolution->occasion == AT_EVENT && resolution->indicator >= first &&
         friction_holds(resolution->instance, resolution->indicator - first);
}

const char *continuity_begin(struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  bool can_matter = switches->branch_count > 0 || switches->assignment_count > 0 || friction_yields(resolution);
  if (lagrangian.constraints.projection == NULL || !can_matter) return NULL;
  if (evaluate_prepare(resolution->instance) != STATUS_DONE) return constraints_not_kept;
  const struct Projection *laws = lagrangian.constraints.projection;
  double moved = laws->project(resolution->instance, resolution->time, resolution->state);
  if (!isfinite(moved) && release_moved(resolution))
    moved = laws->project(resolution->instance, resolution->time, resolution->state);
  if (isfinite(moved)) return NULL;
  log_violated(resolution->instance, resolution->occasion == IN_EXCHANGE ? STATUS_ERROR : STATUS_DISCARD,
               resolution->time, laws->violated_constraint(resolution->instance, resolution->time));
  return constraints_not_kept;
}

void continuity_note(struct Resolution *resolution, size_t branch) {
  const struct SwitchTable *switches = resolution->switches;
  const struct BranchMetadata *metadata = &switches->branches[branch];
  double rate = resolution->value[branch_rate_slot(switches, branch)];
  if (resolution->switched == NULL) {
    resolution->switched = metadata;
    resolution->overshoot = rate != 0.0 ? fabs(resolution->value[branch] / rate) : 0.0;
  }
  if (!metadata->holds_energy || resolution->energetic != NULL) return;
  resolution->energetic = metadata;
  memcpy(resolution->energy, resolution->value + energy_slot(switches), switches->energy_count * sizeof(double));
}

/*
 * Within the overshoot, an acceleration a changes a velocity v by the share a overshoot / scale(v). The factor 4 is a
 * margin for energies, which are quadratic in v.
 */
double continuity_allowed_share(const struct Resolution *resolution) {
  double change = 0.0;
  for (size_t i = 0; i < lagrangian.coordinate_count; i++) {
    size_t velocity = lagrangian.coordinate_count + i;
    change = fmax(change, fabs(resolution->acceleration[i]) / scale_of(resolution->state, velocity));
  }
  return least_kink + 4.0 * resolution->overshoot * change;
}

/*
 * Returns the largest jump among count energies or momenta from first on, relative to their size. Eight rounding error
 * bounds count as no jump.
 */
static double share_of_jump(const struct Resolution *resolution, size_t first, size_t count) {
  size_t slot = energy_slot(resolution->switches) + first;
  const double *before = resolution->energy + first, *behind = resolution->value + slot;
  const double *error_bound = resolution->error_bound + slot;
  double size = 0.0, jump = 0.0;
  for (size_t i = 0; i < count; i++) size = fmax(size, fmax(fabs(before[i]), fabs(behind[i])));
  for (size_t i = 0; i < count; i++)
    if (fabs(behind[i] - before[i]) > 8.0 * error_bound[i]) jump = fmax(jump, fabs(behind[i] - before[i]) / size);
  return jump;
}

/* Logs an energy or momentum that jumps: the velocities after such a jump are not determined. */
static const char *check_energy(const struct Resolution *resolution) {
  bool by_events = resolution->jumped || resolution->set_mode || resolution->occasion == AT_CHANGE;
  if (resolution->energetic == NULL || by_events || resolution->occasion == AT_START) return NULL;
  size_t count = resolution->switches->energy_count;
  double jump = fmax(share_of_jump(resolution, 0, 2), share_of_jump(resolution, 2, count - 2));
  if (!(jump > continuity_allowed_share(resolution))) return NULL;
  log_message(resolution->instance, resolution->occasion == IN_EXCHANGE ? STATUS_ERROR : STATUS_DISCARD,
              "time %g: %s, line %ld of %s, makes an energy or a position jump by a fraction of %.2g; the velocities "
              "after it are not determined; expected energies without jumps, or an <event> that sets the velocities",
              resolution->time, resolution->energetic->function, resolution->energetic->line,
              resolution->energetic->file, jump);
  return "an energy jumps";
}

/* Evaluates value[] for one piece of a branch, at arbitrary velocities, at which pieces of gaps differ. */
static bool values_of_piece(struct Resolution *resolution, size_t branch, double piece, double *value) {
  struct Instance *instance = resolution->instance;
  size_t n = lagrangian.coordinate_count;
  instance->parameter[resolution->switches->branches[branch].mode] = piece;
  instance->parameter_constants_are_stale = true;
  if (evaluate_prepare(instance) != STATUS_DONE) return false;
  memcpy(resolution->rounded, resolution->state, lagrangian.state_count * sizeof *resolution->rounded);
  for (size_t i = 0; i < n; i++) resolution->rounded[n + i] = 1.0 / (1.0 + (double)i);
  struct Point point = solver_point(instance, resolution->time, resolution->rounded);
  resolution_values_of_force(resolution, &point, lagrangian.constraints.count, 0.0, value);
  return true;
}

/*
 * Returns the contact whose gap differs between the pieces of a branch; contact_count for none. Overwrites value and
 * other_error_bound, since the motion ends after the message.
 */
static size_t find_corner(struct Resolution *resolution, size_t branch) {
  const struct SwitchTable *switches = resolution->switches;
  const double *one = resolution->value, *other = resolution->other_error_bound;
  size_t mode = switches->branches[branch].mode, found = 0;
  double kept = mode_of(resolution, mode);
  bool is_known = values_of_piece(resolution, branch, 1.0, resolution->value) &&
                  values_of_piece(resolution, branch, -1.0, resolution->other_error_bound);
  resolution->instance->parameter[mode] = kept;
  resolution->instance->parameter_constants_are_stale = true;
  while (is_known && found < switches->contact_count &&
         one[contact_slot(switches, found, CONTACT_RATE)] == other[contact_slot(switches, found, CONTACT_RATE)])
    found++;
  return is_known ? found : switches->contact_count;
}

bool continuity_explain_corner(struct Resolution *resolution, size_t branch) {
  const struct BranchMetadata *metadata = &resolution->switches->branches[branch];
  size_t contact = find_corner(resolution, branch);
  if (contact == resolution->switches->contact_count) return false;
  bool is_discarded = resolution->occasion == AT_EVENT || resolution->occasion == AT_CHANGE;
  log_message(resolution->instance, is_discarded ? STATUS_DISCARD : STATUS_ERROR,
              "time %g: the gap of the contact '%s' has a corner, by %s, line %ld of %s, and both of its pieces touch; "
              "expected a <contact> for each piece",
              resolution->time, resolution->switches->contacts[contact].name, metadata->function, metadata->line,
              metadata->file);
  return true;
}

const char *continuity_check_corner(struct Resolution *resolution) {
  struct FmuState *fmu_state = resolution->instance->fmu_state;
  if (resolution->occasion != IN_EXCHANGE || resolution->switched == NULL) return NULL;
  bool is_close_to_last = resolution->time - fmu_state->switched <= close_share * fabs(resolution->time);
  fmu_state->close_events = is_close_to_last ? fmu_state->close_events + 1 : 0;
  fmu_state->switched = resolution->time;
  if (fmu_state->close_events < CORNER_LIMIT) return NULL;
  fmu_state->close_events = 0;
  size_t branch = (size_t)(resolution->switched - resolution->switches->branches);
  return continuity_explain_corner(resolution, branch) ? touched_corner : NULL;
}

/* Checks that the constraints hold after branches have switched. Returns NULL, or the reason. */
static const char *check_constraints(struct Resolution *resolution) {
  struct Instance *instance = resolution->instance;
  bool may_change = may_change_gaps(resolution) && !resolution->jumped;
  if (lagrangian.constraints.projection == NULL || !(may_change || resolution->moved)) return NULL;
  if (evaluate_prepare(instance) != STATUS_DONE) return constraints_not_kept;
  bool starts = resolution->occasion == AT_START;
  double moved = starts ? lagrangian.constraints.projection->drift(instance, resolution->time)
                        : lagrangian.constraints.projection->project(instance, resolution->time, resolution->state);
  if (moved <= continuity_allowed_share(resolution)) return NULL;
  enum Status status = starts || resolution->occasion == IN_EXCHANGE ? STATUS_ERROR : STATUS_DISCARD;
  size_t violated_constraint = lagrangian.constraints.projection->violated_constraint(instance, resolution->time);
  const char *name = lagrangian.constraints.names[violated_constraint];
  if (resolution->set_mode || resolution->moved)
    log_message(instance, status,
                "time %g: an event sets %s that violate the %s '%s'; expected a <set> of all its coordinates and "
                "velocities, with values that fulfil it",
                resolution->time, resolution->moved ? "coordinates" : "modes", evaluate_kind(violated_constraint),
                name);
  else if (!continuity_explain_corner(resolution, (size_t)(resolution->switched - resolution->switches->branches)))
    log_message(instance, status,
                "time %g: %s, line %ld of %s, has a kink or jump in the %s '%s', so that positions or velocities would "
                "have to jump; expected one without kinks",
                resolution->time, resolution->switched->function, resolution->switched->line,
                resolution->switched->file, evaluate_kind(violated_constraint), name);
  return constraints_not_kept;
}

const char *continuity_check(struct Resolution *resolution) {
  const char *problem = check_energy(resolution);
  return problem == NULL ? check_constraints(resolution) : problem;
}
