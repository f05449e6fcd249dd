/*
 * Search for events: finds the first time in an interval at which an indicator g_i(t) loses its sign s_i, along the
 * solver's dense output (L. F. Shampine, S. Thompson: Event location for ordinary differential equations, Computers and
 * Mathematics with Applications 39, 2000, describe the problem).
 *
 * f(t) = s_i g_i(t) - floor is sampled at the nine nodes of its Chebyshev polynomial of degree 8. The polynomial's
 * coefficients bound it over the whole interval, not only at samples (search_judge()). It has no zero if c_0
 * exceeds the sum of the other |c_k|. It has at most one falling zero if the same test on its derivative shows that
 * it falls throughout. The same holds if f is not negative at first and concave. The last two coefficients estimate
 * the interpolation error, which must be small and is allowed for. Otherwise the interval is halved, with new
 * samples. So pairs of close zeros, and zeros at the very start, are found with any solver.
 *
 * search_interval.h makes sure that the interval is so short that no function in the indicators can hide between
 * samples. So an event can be missed only within rounding, or if the estimate of the interpolation error fails.
 *
 * A single zero is located by Newton's method on the polynomial, and then by the Illinois method (M. Dowell, P.
 * Jarratt: A modified regula falsi method, BIT 11, 1971) with a bisection at every third step. The search ends:
 * halvings are limited to DEPTH_LIMIT, intervals to INTERVAL_LIMIT, and refinement stops at neighbouring doubles.
 * Usually it costs nine evaluations of all indicators, and a few more for each zero.
 *
 * Indicators are uncertain by rounding. An event may leave one below 0 by that much: the floor is what it may fall to
 * without another event.
 */
#include "detection/search.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "detection/chebyshev.h"
#include "detection/indicators.h"
#include "detection/search_interval.h"
#include "instance/time_laws.h"
#include "support/arena.h"

/*
 * Intervals that a search may examine. An approximate search (BEFORE_IT) gives up earlier and leaves them to the exact
 * one.
 */
enum { INTERVAL_LIMIT = 5000, FEW_INTERVALS = 24 };

/* Halvings of an interval; steps of the Illinois method; of Newton's method on polynomials; evaluations at its zero. */
enum { DEPTH_LIMIT = 48, REFINEMENT_LIMIT = 200, NEWTON_STEPS = 4, NARROWING_LIMIT = 8 };

/* Newton steps on [-1, 1] end below this length: the next one would be lost in rounding. */
static const double near_zero = 1e-6;

/* Factor of the step along the slope, so that the next value lies on the other side of the zero. */
static const double overshoot = 1.1;

/* A search in the solver's last step. The arrays are parts of one workspace. */
struct Search {
  struct Instance *instance;
  double *state, *rounded; /* state_count each: workspace */
  double *values;          /* one for each indicator */
  double *samples;         /* CHEBYSHEV_NODES rows of values */
  double *projected;       /* CHEBYSHEV_NODES rows of values at projected states, where is_projected[node] */
  double *exact;           /* one for each indicator: values at the start */
  double *error_bound;     /* rounding error bounds of the indicators */
  int intervals;           /* number that may still be examined */
  bool is_exact;           /* times are found to rounding; else times before them */
  bool is_projected[CHEBYSHEV_NODES];
  bool projects;    /* project states, so that indicators held at 0 by constraints stay 0 */
  double departure; /* sign of the last indicator that left 0 */
  double floor;     /* value to which the present indicator may fall without an event */
};

/* The samples of search_interval.h come first. */
static size_t lay_out_search(struct Search *search, double *work) {
  struct Arena arena = {(uintptr_t)work};
  arena_take(&arena, search_interval_sample_count(), sizeof(double));
  size_t count = indicator_count(lagrangian.switches);
  ARENA_NUMBERS(&arena, lagrangian.state_count, &search->state, &search->rounded);
  ARENA_NUMBERS(&arena, count, &search->values, &search->error_bound, &search->exact);
  ARENA_NUMBERS(&arena, CHEBYSHEV_NODES * count, &search->samples, &search->projected);
  return (arena.next - (uintptr_t)work) / sizeof(double);
}

size_t search_work_count(void) {
  struct Search search;
  size_t own = lay_out_search(&search, NULL), interval = search_interval_work_count();
  return own > interval ? own : interval;
}

static struct Search search_of(struct Instance *instance) {
  struct Search search = {.instance = instance};
  lay_out_search(&search, instance->switching_work);
  return search;
}

/* Finds the state at a time. False if that fails. */
static bool find_state(struct Search *search, double time) {
  return lagrangian.solver->interpolate(search->instance, time, search->state) &&
         (!search->projects || solver_project(search->instance, time, search->state) == NULL);
}

/* Evaluates the indicators at a time; NAN if they do not exist. */
static void sample(struct Search *search, double time, double *values) {
  size_t count = indicator_count(lagrangian.switches);
  bool known = find_state(search, time) && indicators_at(search->instance, time, search->state, values);
  for (size_t i = 0; i < count && !known; i++) values[i] = NAN;
}

/* Evaluates the indicators at the nodes of an interval. */
static void sample_interval(struct Search *search, double from, double to, const struct IntervalSamples *samples) {
  double times[CHEBYSHEV_NODES];
  size_t count = indicator_count(lagrangian.switches);
  chebyshev_times(from, to, times);
  if (samples->states != NULL)
    indicators_at_times(search->instance, times, CHEBYSHEV_NODES, samples->states, samples->accelerations,
                        search->samples);
  for (size_t k = 0; k < CHEBYSHEV_NODES && samples->states == NULL; k++)
    sample(search, times[k], search->samples + k * count);
}

static double value_at(struct Search *search, size_t indicator, double time) {
  return find_state(search, time) ? indicator_at(search->instance, time, search->state, indicator, search->values)
                                  : NAN;
}

static void measure_error_bound(struct Search *search, double time) {
  size_t count = indicator_count(lagrangian.switches), frictions = friction_indicator(lagrangian.switches, 0);
  double *exact = search->exact;
  sample(search, time, search->values);
  indicator_rounding_bounds(search->instance, time, search->state, search->instance->acceleration, search->error_bound);
  const double *acceleration = search->instance->acceleration;
  double of_contacts = rounding_of_contacts(search->instance, acceleration);
  for (size_t i = 0; i < count; i++)
    if (indicator_is_force(search->instance, i))
      search->error_bound[i] =
          i < frictions ? of_contacts : rounding_at_limit(search->instance, acceleration, i - frictions);
  memcpy(exact, search->values, count * sizeof *exact);
  for (int way = 0; way < 2; way++) {
    bool known =
        indicator_error_bound(search->instance, time, search->state, way == 1, exact, search->rounded, search->values);
    for (size_t i = 0; i < count && known; i++)
      search->error_bound[i] = fmax(search->error_bound[i], search->values[i]);
  }
}

/*
 * True if the coefficients must show that f stays, without computing them. If the values are in [m, M], then c_0 is at
 * least m, each other |c_k| is at most M - m, and the last one half of that.
 */
static bool is_far(const double *f) {
  static const double most = CHEBYSHEV_DEGREE - 0.5, most_of_tail = 1.5;
  double least = INFINITY, largest = -INFINITY;
  for (int k = 0; k <= CHEBYSHEV_DEGREE; k++) {
    if (isnan(f[k])) return false;
    if (f[k] < least) least = f[k];
    if (f[k] > largest) largest = f[k];
  }
  return least > (most + 2.0 * most_of_tail) * (largest - least);
}

enum Verdict search_judge(const double *f, double error_bound) {
  double c[CHEBYSHEV_NODES], d[CHEBYSHEV_NODES], curvature[CHEBYSHEV_NODES], largest = 0.0;
  int missing = 0;
  if (is_far(f)) return STAYS;
  for (int k = 0; k <= CHEBYSHEV_DEGREE; k++) {
    missing += isnan(f[k]) ? 1 : 0;
    if (!(fabs(f[k]) <= largest)) largest = isnan(f[k]) ? INFINITY : fabs(f[k]);
  }
  if (missing > CHEBYSHEV_DEGREE) return STAYS; /* of an inactive piece of a branch */
  if (largest <= error_bound) return STAYS;
  if (isinf(largest)) return UNKNOWN;
  chebyshev_coefficients(f, c);
  double reach = chebyshev_range(c);
  if (reach <= error_bound) return f[0] < -error_bound ? FALLS : STAYS; /* constant within rounding */
  double tail = chebyshev_tail(c);
  if (c[0] - reach > 2.0 * tail) return STAYS;
  if (tail > chebyshev_resolved * reach + error_bound) return UNKNOWN;
  chebyshev_derivative(c, d);
  double margin = chebyshev_tail_of_derivative * tail;
  if (d[0] - chebyshev_range(d) > margin) return STAYS; /* f rises */
  if (-d[0] - chebyshev_range(d) > margin) return f[0] < -error_bound ? FALLS : STAYS;
  chebyshev_derivative(d, curvature);
  bool is_concave = -curvature[0] - chebyshev_range(curvature) > chebyshev_tail_of_curvature * tail;
  if (!is_concave || f[CHEBYSHEV_DEGREE] < 0.0) return UNKNOWN;
  if (f[0] >= -error_bound) return STAYS; /* f rises first, as the height of a thrown body */
  /* If f leaves 0 and returns before the next node, rounding at the start could be taken for the fall. */
  return fmax(f[CHEBYSHEV_DEGREE], f[CHEBYSHEV_DEGREE - 1]) > error_bound ? FALLS : UNKNOWN;
}

/* A time, and the value of f at that time. */
struct Sample {
  double time, f;
};

static struct Sample sample_at(struct Search *search, size_t indicator, double sign, double time) {
  return (struct Sample){time, sign * value_at(search, indicator, time) - search->floor};
}

/*
 * Narrows the bracket of a fall around the zero of the polynomial through f, the values at the nodes. Steps along its
 * slope, a little beyond the zero, bring both ends close.
 */
static void narrow_fall(struct Search *search, size_t indicator, double sign, const double *f, double from, double to,
                        struct Sample *before, struct Sample *behind) {
  double c[CHEBYSHEV_NODES], d[CHEBYSHEV_NODES], half = 0.5 * (to - from);
  double time = before->time + (behind->time - before->time) * (before->f / (before->f - behind->f));
  double slot = (time - from) / half - 1.0;
  chebyshev_coefficients(f, c);
  chebyshev_derivative(c, d);
  double correction = INFINITY;
  for (int i = 0; i < NEWTON_STEPS && fabs(correction) > near_zero; i++) {
    correction = chebyshev_value(c, slot) / chebyshev_value(d, slot);
    slot -= correction;
  }
  double slope = chebyshev_value(d, slot) / half;
  time = from + half * (1.0 + slot);
  for (int i = 0; i < NARROWING_LIMIT && slope < 0.0 && time > before->time && time < behind->time; i++) {
    struct Sample next = sample_at(search, indicator, sign, time);
    double rounding = DBL_EPSILON * fabs(time);
    *(next.f < 0.0 ? behind : before) = next;
    time -= overshoot * next.f / slope + (next.f < 0.0 ? rounding : -rounding);
  }
}

/*
 * Locates the fall of f through 0 between before, where it is not negative, and behind, by the Illinois method with
 * a bisection at every third step. Returns the neighbouring time with the smaller value. Branches and forces get
 * the later one. The next piece of a function exists there, and a contact that opens, or a friction that slips,
 * then moves in its own direction.
 */
static double refine(struct Search *search, size_t indicator, double sign, struct Sample before, struct Sample behind) {
  double weight_before = 1.0, weight_behind = 1.0;
  if (before.f < 0.0 || !search->is_exact) return before.time;
  for (int i = 0; i < REFINEMENT_LIMIT && behind.time - before.time > DBL_EPSILON * fabs(behind.time); i++) {
    double first = weight_before * before.f, last = weight_behind * behind.f,
           middle = 0.5 * (before.time + behind.time);
    double time = i % 3 == 2 ? middle : before.time + (behind.time - before.time) * (first / (first - last));
    if (!(time > before.time && time < behind.time)) time = middle;
    if (!(time > before.time && time < behind.time)) break;
    struct Sample next = sample_at(search, indicator, sign, time);
    bool is_behind = next.f < 0.0;
    weight_before = is_behind ? 0.5 * weight_before : 1.0;
    weight_behind = is_behind ? 1.0 : 0.5 * weight_behind;
    if (is_behind) behind = next;
    else before = next;
  }
  bool is_branch = indicator < lagrangian.switches->branch_count;
  bool is_later = is_branch || indicator_is_force(search->instance, indicator);
  return before.f <= -behind.f && !is_later ? before.time : behind.time;
}

/*
 * Locates the zero in an interval in which f, with these values at the nodes, falls through 0 once. INFINITY if it is
 * behind end.
 */
static double refine_fall(struct Search *search, size_t indicator, double sign, const double *f, double from, double to,
                          double end) {
  int node = CHEBYSHEV_DEGREE;
  if (f[node] < 0.0) return from;
  while (node > 1 && f[node - 1] >= 0.0) node--;
  struct Sample before = {chebyshev_time(from, to, node), f[node]};
  bool may_be_behind = chebyshev_time(from, to, node - 1) > end;
  if (may_be_behind && (before.time > end || sample_at(search, indicator, sign, end).f > 0.0)) return INFINITY;
  struct Sample behind = {chebyshev_time(from, to, node - 1), f[node - 1]};
  narrow_fall(search, indicator, sign, f, from, to, &before, &behind);
  return refine(search, indicator, sign, before, behind);
}

static double first_fall(struct Search *search, size_t indicator, double sign, double from, double to, int depth);

/*
 * Returns the first time up to end at which f falls below 0; INFINITY if there is none. Uses its values at the
 * nodes of an interval to end or beyond.
 */
static double first_fall_in(struct Search *search, size_t indicator, double sign, const double *f, double from,
                            double to, double end, int depth) {
  double error_bound = search->error_bound[indicator];
  enum Verdict verdict = search_judge(f, error_bound);
  if (verdict == STAYS) return INFINITY;
  if (verdict == FALLS) return refine_fall(search, indicator, sign, f, from, to, end);
  double middle = 0.5 * (from + end);
  if (depth == 0 || !(middle > from && middle < end)) {
    bool falls = f[CHEBYSHEV_DEGREE] >= -error_bound && f[0] < -error_bound;
    struct Sample before = {from, f[CHEBYSHEV_DEGREE]}, behind = {to, f[0]};
    return falls ? refine(search, indicator, sign, before, behind) : INFINITY;
  }
  double first = first_fall(search, indicator, sign, from, middle, depth - 1);
  return isfinite(first) ? first : first_fall(search, indicator, sign, middle, end, depth - 1);
}

/* Returns the first time in the interval at which f falls below 0, from new samples; INFINITY if there is none. */
static double first_fall(struct Search *search, size_t indicator, double sign, double from, double to, int depth) {
  double f[CHEBYSHEV_NODES];
  if (--search->intervals < 0) return INFINITY;
  for (int k = 0; k < CHEBYSHEV_NODES; k++) f[k] = sample_at(search, indicator, sign, chebyshev_time(from, to, k)).f;
  return first_fall_in(search, indicator, sign, f, from, to, to, depth);
}

/*
 * Returns the last node at which an indicator at rest at 0 still is 0, and sets departure to its next sign; INFINITY if
 * it stays at 0.
 */
static double first_departure(struct Search *search, size_t indicator, double from, double to) {
  size_t count = indicator_count(lagrangian.switches);
  for (int node = CHEBYSHEV_DEGREE; node >= 0; node--) {
    double value = search->samples[(size_t)node * count + indicator];
    if (!(fabs(value) > search->error_bound[indicator])) continue;
    search->departure = value > 0.0 ? 1.0 : -1.0;
    return chebyshev_time(from, to, node == CHEBYSHEV_DEGREE ? CHEBYSHEV_DEGREE : node + 1);
  }
  return INFINITY;
}

/* Longest extrapolation along a tangent, as a fraction of the scale of the state. */
static const double tangent_share = 1e-9;

/* Returns the time along the tangent, rate, from the end of the last step to the first zero; INFINITY for none. */
static double tangent_to_zero(struct Search *search, double time, const double *rate, size_t *indicator) {
  size_t count = indicator_count(lagrangian.switches);
  double way = INFINITY, share = INFINITY, least = 8.0 * DBL_EPSILON * fabs(time);
  for (size_t i = 0; i < lagrangian.state_count; i++)
    share = fmin(share, tangent_share * scale_of(search->state, i) / fabs(rate[i]));
  share = fmax(share, least);
  if (!indicators_at(search->instance, time, search->state, search->values)) return INFINITY;
  memcpy(search->samples, search->values, count * sizeof *search->samples);
  for (size_t i = 0; i < lagrangian.state_count; i++) search->rounded[i] = search->state[i] + 0.5 * share * rate[i];
  if (!indicators_at(search->instance, time + 0.5 * share, search->rounded, search->values)) return INFINITY;
  for (size_t i = 0; i < count; i++) {
    double sign = indicator_sign(search->instance, i), first = sign * search->samples[i];
    double fall = (first - sign * search->values[i]) / (0.5 * share), zero = first / fall;
    if (sign == 0.0 || !(fall > 0.0) || !(zero >= 0.0 && zero <= share) || zero >= way) continue;
    way = zero;
    *indicator = i;
  }
  return way;
}

/*
 * Returns the branch whose zero the state has passed by rounding, which the search ignores: its piece may end there.
 * branch_count for none.
 */
static size_t find_passed(struct Search *search, double time) {
  size_t count = lagrangian.switches->branch_count;
  sample(search, time, search->values);
  for (size_t i = 0; i < count; i++)
    if (indicator_sign(search->instance, i) * search->values[i] < 0.0) return i;
  return count;
}

bool search_for_jump(struct Instance *instance, double *time, double *state, size_t *indicator) {
  struct Search search = search_of(instance);
  double last = instance->fmu_state->last_step.end, *rate = instance->event_state + lagrangian.state_count;
  if (!lagrangian.solver->interpolate(instance, last, search.state)) return false;
  memcpy(state, search.state, lagrangian.state_count * sizeof *state);
  *time = last;
  *indicator = find_passed(&search, last);
  if (*indicator < lagrangian.switches->branch_count) return true;
  if (!solver_derivatives(instance, last, search.state, rate)) return false;
  double way = tangent_to_zero(&search, last, rate, indicator);
  if (!isfinite(way)) return false;
  way = 1.001 * way + 2.0 * DBL_EPSILON * fabs(last);
  for (size_t i = 0; i < lagrangian.state_count; i++) state[i] = search.state[i] + way * rate[i];
  *time = last + way;
  return true;
}

/* True if the indicator is the velocity of a friction that slides along a line. */
static bool is_of_sliding(const struct Search *search, size_t indicator) {
  const struct SwitchTable *switches = lagrangian.switches;
  size_t first = friction_indicator(switches, 0);
  return indicator >= first && !is_in_plane(switches, indicator - first) &&
         !indicator_is_force(search->instance, indicator);
}

/* True if the indicator is the gap of an open contact. */
static bool is_of_gap(const struct Search *search, size_t indicator) {
  const struct SwitchTable *switches = lagrangian.switches;
  return indicator >= contact_indicator(switches, 0) && indicator < friction_indicator(switches, 0) &&
         !indicator_is_force(search->instance, indicator);
}

/*
 * Returns the value to which an indicator may fall without an event, from its value at the start. An event, or the
 * method, may have left it below 0. The method's errors count for a velocity that begins to slide.
 */
static double floor_of(const struct Search *search, size_t indicator, double start) {
  double error_bound = FLOOR_IN_ERROR_BOUND * search->error_bound[indicator];
  double error = is_of_sliding(search, indicator) ? solver_error(search->instance) : 0.0;
  return start >= -error - error_bound && (error == 0.0 || start <= error + error_bound) ? fmin(start, -error) : 0.0;
}

/* True if the indicator is 0 within rounding while constraints are active. */
static bool may_stay_at_zero(const struct Search *search, size_t indicator) {
  return fabs(search->exact[indicator]) <= search->error_bound[indicator] && solver_has_constraints(search->instance);
}

/*
 * True for a velocity that is 0 within rounding while constraints are active: they may keep it at 0. In a long step,
 * rounding of the accelerations would show in it. A gap is left at once.
 */
static bool may_be_constrained(const struct Search *search, size_t indicator) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool is_gap = indicator >= contact_indicator(switches, 0) && indicator < friction_indicator(switches, 0);
  return !is_gap && may_stay_at_zero(search, indicator);
}

/* Returns the value of an indicator at the projected state of a node. Those of all indicators are computed at once. */
static double projected_sample(struct Search *search, size_t indicator, double from, double to, int node) {
  double *row = search->projected + (size_t)node * indicator_count(lagrangian.switches);
  search->projects = true;
  if (!search->is_projected[node]) sample(search, chebyshev_time(from, to, node), row);
  search->is_projected[node] = true;
  return row[indicator];
}

/* Sets the samples of one indicator to those at projected states. */
static void project_samples(struct Search *search, size_t indicator, double from, double to) {
  size_t count = indicator_count(lagrangian.switches);
  for (int node = 0; node < CHEBYSHEV_NODES; node++)
    search->samples[(size_t)node * count + indicator] = projected_sample(search, indicator, from, to, node);
}

/*
 * True for the gap of an open contact that is 0 within rounding during the whole interval, as closed contacts hold it.
 * An example is a table that stands on three of its legs, and touches with the fourth.
 */
static bool keeps_touching(struct Search *search, size_t indicator, double from, double to) {
  if (!is_of_gap(search, indicator) || !may_stay_at_zero(search, indicator)) return false;
  bool keeps = true;
  for (int node = 0; node < CHEBYSHEV_NODES && keeps; node++)
    keeps = fabs(projected_sample(search, indicator, from, to, node)) <= search->error_bound[indicator];
  return keeps;
}

/*
 * Returns the time of the first <sample> in [from, to], and its branch; INFINITY if all are later. Rounding of
 * communication points may leave one before `from`, which then happens at `from`.
 */
static double first_sample(const struct Instance *instance, double from, double to, size_t *branch) {
  double first = INFINITY;
  for (size_t i = 0; i < lagrangian.switches->sample_count; i++) {
    const struct SampleMetadata *sample = &lagrangian.switches->samples[i];
    double time = fmax(sample_time(instance, sample), from);
    if (!(time <= to && time < first)) continue;
    first = time;
    *branch = sample->branch;
  }
  return first;
}

bool search_for_event(struct Instance *instance, double from, double to, const struct IntervalSamples *samples,
                      enum Exactness exactness, double *time, size_t *indicator) {
  size_t count = indicator_count(lagrangian.switches);
  struct Search search = search_of(instance);
  search.is_exact = exactness == TO_ROUNDING;
  search.intervals = search.is_exact ? INTERVAL_LIMIT : FEW_INTERVALS;
  bool knows_error_bound = false;
  sample_interval(&search, from, to, samples);
  *time = first_sample(instance, from, to, indicator);
  bool leaves = false; /* the zero is one that an indicator at rest leaves */
  for (size_t i = 0; i < count; i++) {
    if (sample_of(lagrangian.switches, i) != NULL) continue;
    double f[CHEBYSHEV_NODES], sign = indicator_sign(instance, i);
    for (int k = 0; k < CHEBYSHEV_NODES; k++) f[k] = sign * search.samples[(size_t)k * count + i];
    if (sign != 0.0 && search_judge(f, 0.0) == STAYS) continue;
    if (!knows_error_bound) measure_error_bound(&search, from);
    knows_error_bound = true;
    if (keeps_touching(&search, i, from, to)) continue;
    search.projects = may_be_constrained(&search, i);
    if (search.projects) project_samples(&search, i, from, to);
    double start = sign * search.samples[(size_t)CHEBYSHEV_DEGREE * count + i];
    search.floor = floor_of(&search, i, start);
    for (int k = 0; k < CHEBYSHEV_NODES; k++) f[k] = sign * search.samples[(size_t)k * count + i] - search.floor;
    double found = sign == 0.0 ? first_departure(&search, i, from, to)
                               : first_fall_in(&search, i, sign, f, from, to, fmin(to, *time), DEPTH_LIMIT);
    bool is_lost = search.intervals < 0;
    /* An indicator at rest gets its sign after the others at this time have switched, such as a friction. */
    if (!is_lost && !(found < *time) && !(leaves && found == *time && sign != 0.0)) continue;
    *time = is_lost ? NAN : found;
    *indicator = i;
    leaves = sign == 0.0;
    if (is_lost) return true;
    instance->departure = search.departure;
  }
  search.projects = false;
  if (!isfinite(*time)) return false;
  instance->was_at_zero = false;
  if (sample_of(lagrangian.switches, *indicator) != NULL) return true;
  double before = value_at(&search, *indicator, 0.5 * (from + *time));
  instance->was_at_zero = fabs(before) <= FLOOR_IN_ERROR_BOUND * search.error_bound[*indicator];
  return true;
}
