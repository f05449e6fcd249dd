#include "events/search.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evaluation/evaluate.h"
#include "evaluation/services.h"
#include "events/chebyshev.h"
#include "events/indicators.h"
#include "events/window.h"
#include "instance/time_laws.h"

/* Windows that a search may look at. Where one that is not exact takes more than a few, it is left to the exact one. */
enum { WINDOW_LIMIT = 5000, FEW_WINDOWS = 24 };

enum { DEPTH_LIMIT = 48, REFINEMENT_LIMIT = 200, NEWTON_STEPS = 4, NARROWING_LIMIT = 8 };

/* A step of Newton's method as short as this, of windows from -1 to 1, ends where the next one would not count. */
static const double near_zero = 1e-6;

/* How far the slope leads beyond a zero: the next value then lies on the other side. */
static const double overshoot = 1.1;

struct Search {
  struct Instance *instance;
  double *state, *rounded; /* state_count each */
  double *values;          /* one a indicator */
  double *samples;         /* CHEBYSHEV_NODES rows of them */
  double *held;            /* the same with states on the constraints, where has_held */
  double *exact;           /* one a indicator */
  double *noise;           /* what rounding may make of each */
  int windows;             /* that may still be looked at */
  bool is_exact;           /* times are found to rounding, else ones a little before */
  bool has_held;
  bool projects;    /* states onto the constraints: what they hold at 0 is not what rounding makes of it */
  double departure; /* the sign of what left 0 last */
  double floor;     /* what an event has left of an indicator below 0, by rounding */
};

size_t search_work_count(void) {
  size_t search = window_sample_count() + 2 * lagrangian.state_count +
                  (2 * CHEBYSHEV_NODES + 3) * indicator_count(lagrangian.switches);
  size_t window = window_work_count();
  return search > window ? search : window;
}

static struct Search search_of(struct Instance *instance) {
  size_t count = indicator_count(lagrangian.switches);
  struct Search search = {.instance = instance, .state = instance->switching_work + window_sample_count()};
  search.rounded = search.state + lagrangian.state_count;
  search.values = search.rounded + lagrangian.state_count;
  search.samples = search.values + count;
  search.noise = search.samples + CHEBYSHEV_NODES * count;
  search.exact = search.noise + count;
  search.held = search.exact + count;
  return search;
}

/* The values at a time; NAN where there are none. */
static void sample(struct Search *search, double time, double *values) {
  size_t count = indicator_count(lagrangian.switches);
  bool known = lagrangian.solver->interpolate(search->instance, time, search->state);
  if (search->projects) known = known && solver_project(search->instance, time, search->state) == NULL;
  known = known && indicators_at(search->instance, time, search->state, values);
  for (size_t i = 0; i < count && !known; i++) values[i] = NAN;
}

/* Those at the nodes of a window; states: there, NULL where they are not all known. */
static void sample_window(struct Search *search, double from, double to, const double *states) {
  double times[CHEBYSHEV_NODES];
  size_t count = indicator_count(lagrangian.switches);
  chebyshev_times(from, to, times);
  if (states != NULL) indicators_at_times(search->instance, times, CHEBYSHEV_NODES, states, search->samples);
  for (size_t k = 0; k < CHEBYSHEV_NODES && states == NULL; k++) sample(search, times[k], search->samples + k * count);
}

static double value_at(struct Search *search, size_t indicator, double time) {
  sample(search, time, search->values);
  return search->values[indicator];
}

static void measure_noise(struct Search *search, double time) {
  size_t count = indicator_count(lagrangian.switches);
  double *exact = search->exact;
  sample(search, time, search->values);
  indicator_roundings(search->instance, time, search->state, search->instance->acceleration, search->noise);
  for (size_t i = 0; i < count; i++)
    if (indicator_is_force(search->instance, i)) search->noise[i] = 0.0;
  memcpy(exact, search->values, count * sizeof *exact);
  for (int way = 0; way < 2; way++) {
    bool known =
        indicator_noise(search->instance, time, search->state, way == 1, exact, search->rounded, search->values);
    for (size_t i = 0; i < count && known; i++) search->noise[i] = fmax(search->noise[i], search->values[i]);
  }
}

enum Verdict { STAYS, FALLS, UNKNOWN };

/* f: values at the nodes, positive while the mode stays. */
static enum Verdict judge_signs(const double *f, double noise) {
  double c[CHEBYSHEV_NODES], d[CHEBYSHEV_NODES], curvature[CHEBYSHEV_NODES], largest = 0.0;
  int missing = 0;
  for (int k = 0; k <= CHEBYSHEV_DEGREE; k++) {
    missing += isnan(f[k]) ? 1 : 0;
    if (!(fabs(f[k]) <= largest)) largest = isnan(f[k]) ? INFINITY : fabs(f[k]);
  }
  if (missing > CHEBYSHEV_DEGREE) return STAYS; /* a branch inside of a piece that is closed */
  if (largest <= noise) return STAYS;
  if (isinf(largest)) return UNKNOWN;
  chebyshev_coefficients(f, c);
  double reach = chebyshev_range(c);
  if (reach <= noise) return f[0] < -noise ? FALLS : STAYS; /* unless it has fallen, it does not, whatever it is */
  double tail = chebyshev_tail(c);
  if (c[0] - reach > 2.0 * tail) return STAYS;
  if (tail > chebyshev_resolved * reach + noise) return UNKNOWN;
  chebyshev_derivative(c, d);
  double margin = chebyshev_tail_of_derivative * tail;
  if (d[0] - chebyshev_range(d) > margin) return STAYS; /* it rises */
  if (-d[0] - chebyshev_range(d) > margin) return f[0] < -noise ? FALLS : STAYS;
  chebyshev_derivative(d, curvature);
  bool is_concave = -curvature[0] - chebyshev_range(curvature) > chebyshev_tail_of_curvature * tail;
  if (!is_concave || f[CHEBYSHEV_DEGREE] < 0.0) return UNKNOWN;
  if (f[0] >= -noise) return STAYS; /* as a body that is thrown */
  /* One that leaves 0 and is back before the next node: rounding at its start would pass for the fall. */
  return fmax(f[CHEBYSHEV_DEGREE], f[CHEBYSHEV_DEGREE - 1]) > noise ? FALLS : UNKNOWN;
}

/* A time, and f there: what is looked for less its floor. */
struct Sample {
  double time, f;
};

static struct Sample sample_at(struct Search *search, size_t indicator, double sign, double time) {
  return (struct Sample){time, sign * value_at(search, indicator, time) - search->floor};
}

/*
 * Narrows the two sides of a fall to where the polynomial through f, the values at the nodes, has it: its slope leads from one
 * side to the other, and a little beyond, so that both come near.
 */
static void narrow_fall(struct Search *search, size_t indicator, double sign, const double *f, double from, double to,
                        struct Sample *before, struct Sample *behind) {
  double c[CHEBYSHEV_NODES], d[CHEBYSHEV_NODES], half = 0.5 * (to - from);
  double time = before->time + (behind->time - before->time) * (before->f / (before->f - behind->f));
  double place = (time - from) / half - 1.0;
  chebyshev_coefficients(f, c);
  chebyshev_derivative(c, d);
  double correction = INFINITY;
  for (int i = 0; i < NEWTON_STEPS && fabs(correction) > near_zero; i++) {
    correction = chebyshev_value(c, place) / chebyshev_value(d, place);
    place -= correction;
  }
  double slope = chebyshev_value(d, place) / half;
  time = from + half * (1.0 + place);
  for (int i = 0; i < NARROWING_LIMIT && slope < 0.0 && time > before->time && time < behind->time; i++) {
    struct Sample next = sample_at(search, indicator, sign, time);
    double rounding = DBL_EPSILON * fabs(time);
    *(next.f < 0.0 ? behind : before) = next;
    time -= overshoot * next.f / slope + (next.f < 0.0 ? rounding : -rounding);
  }
}

/*
 * Where f falls through 0, between a time before, where it is not negative, and one behind: of the two neighbouring times the
 * one where it is smaller, or the later one of a branch, where the next piece has a value, and of a force: what gives way
 * there moves in its direction, and not back by what the force still lacks.
 * By the Illinois method, with every third step a bisection.
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

/* The same in a window in which f, with these values at the nodes, falls through 0 once. */
static double refine_fall(struct Search *search, size_t indicator, double sign, const double *f, double from,
                          double to) {
  int node = CHEBYSHEV_DEGREE;
  if (f[node] < 0.0) return from;
  while (node > 1 && f[node - 1] >= 0.0) node--;
  struct Sample before = {chebyshev_time(from, to, node), f[node]};
  struct Sample behind = {chebyshev_time(from, to, node - 1), f[node - 1]};
  narrow_fall(search, indicator, sign, f, from, to, &before, &behind);
  return refine(search, indicator, sign, before, behind);
}

static double first_fall(struct Search *search, size_t indicator, double sign, double from, double to, int depth);

/*
 * The first time up to an end at which f = sign times the indicator less the floor falls below 0, from its values at the nodes
 * of a window that reaches to the end or further; INFINITY where it does not.
 */
static double first_fall_in(struct Search *search, size_t indicator, double sign, const double *f, double from,
                            double to, double end, int depth) {
  double noise = search->noise[indicator];
  enum Verdict verdict = judge_signs(f, noise);
  if (verdict == STAYS) return INFINITY;
  if (verdict == FALLS) return refine_fall(search, indicator, sign, f, from, to);
  double middle = 0.5 * (from + end);
  if (depth == 0 || !(middle > from && middle < end)) {
    bool falls = f[CHEBYSHEV_DEGREE] >= -noise && f[0] < -noise;
    struct Sample before = {from, f[CHEBYSHEV_DEGREE]}, behind = {to, f[0]};
    return falls ? refine(search, indicator, sign, before, behind) : INFINITY;
  }
  double first = first_fall(search, indicator, sign, from, middle, depth - 1);
  return isfinite(first) ? first : first_fall(search, indicator, sign, middle, end, depth - 1);
}

/* The same in a window that was not looked at yet. */
static double first_fall(struct Search *search, size_t indicator, double sign, double from, double to, int depth) {
  double f[CHEBYSHEV_NODES];
  if (--search->windows < 0) return INFINITY;
  for (int k = 0; k < CHEBYSHEV_NODES; k++) f[k] = sample_at(search, indicator, sign, chebyshev_time(from, to, k)).f;
  return first_fall_in(search, indicator, sign, f, from, to, to, depth);
}

/*
 * Where an indicator that rests at 0 leaves it: the last of some times at which it is still 0, with the sign that it has
 * then. INFINITY where it stays.
 */
static double first_departure(struct Search *search, size_t indicator, double from, double to) {
  size_t count = indicator_count(lagrangian.switches);
  for (int node = CHEBYSHEV_DEGREE; node >= 0; node--) {
    double value = search->samples[(size_t)node * count + indicator];
    if (!(fabs(value) > search->noise[indicator])) continue;
    search->departure = value > 0.0 ? 1.0 : -1.0;
    return chebyshev_time(from, to, node == CHEBYSHEV_DEGREE ? CHEBYSHEV_DEGREE : node + 1);
  }
  return INFINITY;
}

/* How far a tangent may lead, as a share of the scale of the state. */
static const double tangent_share = 1e-9;

/* The time along the tangent, rate, from the state at last->end to the first zero of an indicator; INFINITY for none. */
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
 * The branch whose zero the state has passed by no more than rounding, which no search tells from none: its piece may have
 * no value there. branch_count for none.
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
  double last = instance->situation->last_step.end, *rate = instance->event_state + lagrangian.state_count;
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

/* Whether it is the velocity of a friction that slides along a line. */
static bool is_of_sliding(const struct Search *search, size_t indicator) {
  const struct SwitchTable *switches = lagrangian.switches;
  size_t first = friction_indicator(switches, 0);
  return indicator >= first && !is_in_plane(switches, indicator - first) &&
         !indicator_is_force(search->instance, indicator);
}

/*
 * What an indicator may fall to without an event, that begins at a value: what an event, or the method, has made of it. The
 * method errs where it begins, too, in the velocity of what begins to slide and in the gap of what is lifted.
 */
static double floor_of(const struct Search *search, size_t indicator, double start, const size_t *lifted) {
  double noise = FLOOR_IN_NOISE * search->noise[indicator], error = 0.0;
  bool is_lifted = lifted != NULL && *lifted == indicator;
  if (is_lifted || is_of_sliding(search, indicator)) error = solver_error(search->instance);
  return start >= -error - noise && (error == 0.0 || start <= error + noise) ? fmin(start, -error) : 0.0;
}

/*
 * Whether it is a velocity that is 0 within rounding while constraints hold: they may be what holds it, and in a long step
 * rounding of the accelerations shows in it. A gap is left at once.
 */
static bool may_be_held(const struct Search *search, size_t indicator) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool is_gap = indicator >= contact_indicator(switches, 0) && indicator < friction_indicator(switches, 0);
  return !is_gap && fabs(search->exact[indicator]) <= search->noise[indicator] && solver_is_held(search->instance);
}

/* The values of one indicator at the nodes, with states on the constraints: those of all are found at once. */
static void hold_nodes(struct Search *search, size_t indicator, double from, double to) {
  size_t count = indicator_count(lagrangian.switches);
  for (size_t k = 0; k < CHEBYSHEV_NODES && !search->has_held; k++)
    sample(search, chebyshev_time(from, to, (int)k), search->held + k * count);
  search->has_held = true;
  for (size_t k = 0; k < CHEBYSHEV_NODES; k++)
    search->samples[k * count + indicator] = search->held[k * count + indicator];
}

/*
 * The time of the first sample up to an end, and its branch; INFINITY where all are later. One that lies before the beginning was
 * passed by the rounding of communication points, and happens there.
 */
static double first_sample(const struct Instance *instance, double from, double to, size_t *branch) {
  double first = INFINITY;
  for (size_t i = 0; i < lagrangian.switches->sample_count; i++) {
    const struct SampleFacts *sample = &lagrangian.switches->samples[i];
    double time = fmax(sample_time(instance, sample), from);
    if (!(time <= to && time < first)) continue;
    first = time;
    *branch = sample->branch;
  }
  return first;
}

bool search_for_event(struct Instance *instance, double from, double to, const double *samples, const size_t *lifted,
                      enum Exactness exactness, double *time, size_t *indicator) {
  size_t count = indicator_count(lagrangian.switches);
  struct Search search = search_of(instance);
  search.is_exact = exactness == TO_ROUNDING;
  search.windows = search.is_exact ? WINDOW_LIMIT : FEW_WINDOWS;
  bool knows_noise = false;
  sample_window(&search, from, to, samples);
  *time = first_sample(instance, from, to, indicator);
  bool leaves = false; /* it is a zero at which the indicator rested */
  for (size_t i = 0; i < count; i++) {
    if (sample_of(lagrangian.switches, i) != NULL) continue;
    double f[CHEBYSHEV_NODES], sign = indicator_sign(instance, i);
    for (int k = 0; k < CHEBYSHEV_NODES; k++) f[k] = sign * search.samples[(size_t)k * count + i];
    if (sign != 0.0 && judge_signs(f, 0.0) == STAYS) continue;
    if (!knows_noise) measure_noise(&search, from);
    knows_noise = true;
    search.projects = may_be_held(&search, i);
    if (search.projects) hold_nodes(&search, i, from, to);
    double start = sign * search.samples[(size_t)CHEBYSHEV_DEGREE * count + i];
    search.floor = floor_of(&search, i, start, lifted);
    for (int k = 0; k < CHEBYSHEV_NODES; k++) f[k] = sign * search.samples[(size_t)k * count + i] - search.floor;
    double found = sign == 0.0 ? first_departure(&search, i, from, to)
                               : first_fall_in(&search, i, sign, f, from, to, fmin(to, *time), DEPTH_LIMIT);
    bool is_lost = search.windows < 0;
    /* What it leaves with is known once what falls there too has switched, such as a friction. */
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
  instance->was_at_zero = fabs(before) <= FLOOR_IN_NOISE * search.noise[*indicator];
  return true;
}
