/*
 * The impacts of an event. An impact takes the touching contact that closes fastest, together with those as fast
 * within rounding; the other touching contacts are open. Contacts that close because of it have impacts of their own
 * after it. So a row of touching bodies passes an impulse on (Newton's cradle).
 *
 * All that touch are taken at once, without restitution, if none would bounce visibly, and after too many impacts.
 * Contacts that come to rest then may close others, which are taken in the same way. Each time, kinetic energy is lost.
 * If a contact closes after PLASTIC_LIMIT of these, bodies are crushed, and the motion ends.
 *
 * Bodies that touch may need thousands of impacts. Without friction on them, and with constant restitutions, the
 * Delassus matrix W of all that touch gives all their rates. An impact then costs one column of W.
 */
#include "nonsmooth/contacts/impact_sequence.h"

#include <float.h>
#include <math.h>

#include "nonsmooth/contacts/contact_forces.h"
#include "nonsmooth/contacts/contact_impulses.h"
#include "nonsmooth/contacts/impacts.h"
#include "nonsmooth/contacts/planes.h"

const char impact_without_solution[] = "an impact of a contact has no solution";

/*
 * IMPACT_LIMIT: impacts of an event one after another. With friction on contacts each is a problem of its own, and there
 * may be fewer. PLASTIC_LIMIT: further ones, of all contacts that touch.
 */
enum { IMPACT_LIMIT = 100000, FRICTION_IMPACT_LIMIT = 1000, PLASTIC_LIMIT = 100 };

/* Closing speeds with a smaller relative difference are equal, so that impacts of symmetric systems stay symmetric. */
static const double equal_share = 1e-9;

/* Iterations leave closing rates below this share of the largest one in the event; impacts at them have no energy. */
static const double unresolved_share = 1e-6;

/*
 * True if the rate of a contact is an error of the solver. No velocity has jumped at the event of another element, and
 * the contact was closed up to it, or touches without a visible rate.
 */
static bool is_error_of_solver(const struct Resolution *resolution, size_t contact) {
  if (resolution->occasion != AT_EVENT || resolution->jumped || may_change_gaps(resolution)) return false;
  bool is_other = !is_hit(resolution, contact_indicator(resolution->switches, contact));
  return first_mode_of(resolution, resolution->switches->contacts[contact].mode) > 0.0 ||
         (is_other && -contact_value(resolution, contact, CONTACT_RATE) <= resolution->tolerances.rest);
}

/*
 * Returns the touching contact that closes fastest; contact_count for none. Rates within rounding count only for the
 * contact whose zero was located, before its first impact.
 */
static size_t find_impact(const struct Resolution *resolution) {
  size_t found = resolution->switches->contact_count;
  double fastest = 0.0;
  for (size_t i = 0; i < resolution->switches->contact_count; i++) {
    size_t rate = contact_slot(resolution->switches, i, CONTACT_RATE);
    bool is_open = !contact_is_closed(resolution, i) && resolution->forced[i] == UNFORCED;
    bool is_hit_first =
        is_hit(resolution, contact_indicator(resolution->switches, i)) && is_open && resolution->impacts == 0;
    double error = fmax(resolution->error_bound[rate], resolution->lost_speed);
    bool closes = resolution->value[rate] < (is_hit_first ? 0.0 : -error);
    if (!closes || is_error_of_solver(resolution, i) || !is_touching(resolution, i) ||
        resolution->value[rate] >= fastest)
      continue;
    fastest = resolution->value[rate];
    found = i;
  }
  return found;
}

/* Returns the largest rate of the contacts that touch, since the start of the event. */
static double fastest_of_event(const struct Resolution *resolution) {
  double fastest = 0.0;
  for (size_t i = 0; i < resolution->switches->contact_count; i++)
    if (is_touching(resolution, i))
      fastest = fmax(fastest, resolution->largest[contact_slot(resolution->switches, i, CONTACT_RATE)]);
  return fastest;
}

static int impact_limit(const struct Resolution *resolution) {
  return resolution->switches->rests_on == NULL ? IMPACT_LIMIT : FRICTION_IMPACT_LIMIT;
}

/*
 * True if a contact that touches would bounce visibly from an impact at a speed. Once an event has more impacts than
 * touching contacts, bodies exchange impulses repeatedly, and others press the contacts together.
 */
static bool any_bounces(const struct Resolution *resolution, double speed) {
  size_t contacts = 0;
  bool any = false;
  for (size_t i = 0; i < resolution->switches->contact_count; i++) contacts += is_touching(resolution, i) ? 1 : 0;
  bool is_passed_back = resolution->impacts > (int)contacts;
  for (size_t i = 0; i < resolution->switches->contact_count && !any; i++) {
    double rate = contact_value(resolution, i, CONTACT_RESTITUTION) * speed;
    any = is_touching(resolution, i) &&
          !(is_passed_back ? bounce_is_lost_beside_others(resolution, i, rate) : bounce_is_lost(resolution, i, rate));
  }
  return any;
}

/*
 * True if the impact of a contact is taken by itself, and others follow from it. False for one of all that touch. Then
 * none of them would bounce visibly, or this one has 1e-12 of the largest energy, or there were too many impacts.
 */
static bool passes_on(const struct Resolution *resolution, size_t contact) {
  double speed = -contact_value(resolution, contact, CONTACT_RATE);
  return speed > unresolved_share * fastest_of_event(resolution) && any_bounces(resolution, speed) &&
         resolution->impacts < impact_limit(resolution);
}

/* True if a contact still closes after an impact of all that touch, not only by uncertain directions of the gaps. */
static bool closes_clearly(const struct Resolution *resolution, size_t contact) {
  return contact_value(resolution, contact, CONTACT_RATE) < -resolution->tolerances.uncertain;
}

static void open_all(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->contact_count; i++) set_contact(resolution, i, false);
}

static bool has_valid_restitution(const struct Resolution *resolution, size_t contact) {
  double restitution = contact_value(resolution, contact, CONTACT_RESTITUTION);
  return restitution >= 0.0 && restitution <= 1.0;
}

/* Logs a restitution outside of 0 to 1, and returns false. */
static bool check_restitution(const struct Resolution *resolution, size_t contact) {
  if (has_valid_restitution(resolution, contact)) return true;
  log_message(resolution->instance, STATUS_DISCARD,
              "time %g: the restitution of the contact '%s' is %g; expected one from 0 to 1", resolution->time,
              resolution->switches->contacts[contact].name, contact_value(resolution, contact, CONTACT_RESTITUTION));
  return false;
}

/* True if a contact that touches closes as fast as the given one, up to rounding. */
static bool is_tied(const struct Resolution *resolution, size_t contact, size_t other) {
  size_t slot = contact_slot(resolution->switches, contact, CONTACT_RATE);
  size_t rate = contact_slot(resolution->switches, other, CONTACT_RATE);
  double fastest = resolution->value[slot], slower = resolution->value[rate] - fastest;
  return slower <= resolution->error_bound[slot] + resolution->error_bound[rate] - equal_share * fastest;
}

/*
 * Selects all frictions, and the contacts that close as fast as the given one, up to rounding. If the impact does not
 * pass on, it selects all touching contacts. False after logging an invalid restitution.
 */
static bool choose_hit(struct Resolution *resolution, size_t contact, bool passes) {
  const struct SwitchTable *switches = resolution->switches;
  bool is_fine = true;
  for (size_t i = 0; i < switches->contact_count; i++) {
    bool is_hit = is_touching(resolution, i) && (!passes || is_tied(resolution, contact, i));
    resolution->part[i] = is_hit ? TAKES_PART : LEFT_OUT;
    if (resolution->part[i] == LEFT_OUT) continue;
    is_fine &= check_restitution(resolution, i);
    resolution->forced[i] = UNFORCED;
  }
  for (size_t i = 0; i < switches->friction_count; i++) *part_of_friction(resolution, i) = TAKES_PART;
  return is_fine;
}

static void let_all_slide(struct Resolution *resolution) {
  for (size_t i = 0; i < resolution->switches->friction_count; i++) set_friction(resolution, i, 1.0);
}

void impact_leave_open(struct Resolution *resolution) {
  open_all(resolution);
  let_unpressed_slide(resolution);
  resolution->jumped = true;
  resolution->impacts++;
}

/* Takes an impact of a contact and of those that are hit with it; leaves all contacts open. False if it fails. */
static bool take_impact(struct Resolution *resolution, size_t contact) {
  bool passes = passes_on(resolution, contact);
  if (resolution->impacts == impact_limit(resolution))
    log_message(resolution->instance, STATUS_WARNING,
                "time %g: after %d impacts at one time, the last one of '%s', contacts that touch lose all energy of "
                "their impacts",
                resolution->time, impact_limit(resolution), resolution->switches->contacts[contact].name);
  if (!choose_hit(resolution, contact, passes)) return false;
  resolution_keep_modes(resolution);
  let_all_slide(resolution);
  open_all(resolution);
  bool done = impacts_take(resolution, passes);
  resolution_restore_modes(resolution);
  impact_leave_open(resolution);
  if (!passes) resolution->plastic_impacts++;
  return done && let_stopped_slip(resolution);
}

/* Logs singular equations, which name no contact by themselves; other reasons have been logged. */
static const char *report_singular_impact(const struct Resolution *resolution, size_t contact) {
  if (resolution->instance->singular != 0)
    log_message(resolution->instance, resolution_status(resolution),
                "time %g: the impact of the contact '%s' has no solution, as the equations of motion are singular "
                "without contacts; expected masses for all coordinates",
                resolution->time, resolution->switches->contacts[contact].name);
  return impact_without_solution;
}

/* True if rates alone decide on the impacts of the contacts that take part. */
static bool rates_decide(const struct Resolution *resolution) {
  const struct SwitchTable *switches = resolution->switches;
  bool decide = true;
  for (size_t i = 0; i < switches->contact_count && decide; i++) {
    if (resolution->part[i] == LEFT_OUT) continue;
    decide = switches->contacts[i].restitution_is_constant && has_valid_restitution(resolution, i);
    for (size_t k = 0; k < switches->friction_count; k++) decide &= !rests_on(switches, k, i);
  }
  return decide;
}

/* Returns the row of the next impact of a single contact; the number of rows if there is none. */
static size_t find_single(const struct Resolution *resolution, const struct ContactImpulses *impulses) {
  size_t contact = find_impact(resolution), found = impulses->count;
  if (contact == resolution->switches->contact_count || !passes_on(resolution, contact)) return found;
  for (size_t row = 0; row < impulses->count; row++) {
    size_t other = impulses->member[row];
    if (other == contact) found = row;
    else if (is_tied(resolution, contact, other)) return impulses->count;
  }
  bool moves = found < impulses->count && impulses->delassus[found * impulses->count + found] > DBL_MIN;
  return moves ? found : impulses->count;
}

/* Takes the impact of one contact: changes the velocities, and the rates of all rows. */
static void take_single(struct Resolution *resolution, const struct ContactImpulses *impulses, size_t row) {
  size_t n = impulses->count, contact = impulses->member[row];
  double rate = contact_value(resolution, contact, CONTACT_RATE);
  double impulse = -(1.0 + impact_restitution(resolution, contact)) * rate / impulses->delassus[row * n + row];
  for (size_t i = 0; i < n; i++) {
    size_t slot = contact_slot(resolution->switches, impulses->member[i], CONTACT_RATE);
    resolution->value[slot] += impulses->delassus[i * n + row] * impulse;
    resolution->largest[slot] = fmax(resolution->largest[slot], fabs(resolution->value[slot]));
  }
  impact_add(resolution, impulses, row, impulse);
  resolution->forced[contact] = UNFORCED;
  resolution->impacts++;
}

/*
 * Takes impacts of single contacts without friction as long as they pass on, and evaluates the rates anew. Before that,
 * there were as many impacts as contacts that touch: W costs as much as these. False if values do not exist, without
 * memory, or if M is singular.
 */
static bool take_singles(struct Resolution *resolution) {
  struct ContactImpulses impulses;
  int before = resolution->impacts;
  if (before <= (int)choose_touching(resolution, LEFT_OUT) || !rates_decide(resolution)) return true;
  if (!contact_impulses_create(resolution, &impulses)) return false;
  for (size_t row = find_single(resolution, &impulses); row < impulses.count; row = find_single(resolution, &impulses))
    take_single(resolution, &impulses, row);
  contact_impulses_free(resolution, &impulses);
  return resolution->impacts == before || resolution_evaluate_rates(resolution);
}

/*
 * Takes the impact of a contact, and those that follow from it. Rates decide on these; the accelerations of the round
 * after the first one, with all contacts open, decide which bounces are lost.
 */
static const char *take_impacts(struct Resolution *resolution, size_t contact) {
  size_t count = resolution->switches->contact_count;
  do {
    if (!take_impact(resolution, contact)) return report_singular_impact(resolution, contact);
    if (resolution->impacts == 1 || !resolution_evaluate_rates(resolution)) return NULL; /* the next round evaluates */
    if (!take_singles(resolution)) return report_singular_impact(resolution, contact);
    contact = find_impact(resolution);
  } while (contact < count && resolution->plastic_impacts <= PLASTIC_LIMIT);
  return NULL;
}

bool takes_impacts(struct Resolution *resolution, const char **problem) {
  size_t contact = find_impact(resolution);
  bool hits = contact < resolution->switches->contact_count;
  bool is_tried = resolution->plastic_impacts > PLASTIC_LIMIT;
  if (!hits || (is_tried && !closes_clearly(resolution, contact))) return false;
  *problem = is_tried ? contact_forces_report_crushed(resolution, contact) : take_impacts(resolution, contact);
  return true;
}
