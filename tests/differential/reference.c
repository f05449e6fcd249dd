/*
 * A reference integrator in long doubles: extrapolation of the modified midpoint rule (Hairer, Norsett, Wanner:
 * Solving Ordinary Differential Equations I, section II.9). Beside the usual error control, each step bounds the
 * change of the operands of functions. The bound is a fraction of the scale on which the function varies. So no
 * narrow feature is stepped over.
 */
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { STATES = 20, COLUMNS = 12, GUARDS = 400 };

typedef long double real;

/* Computes the derivative of the state, and the operands of functions with their scales. */
typedef void (*Right)(real time, const real *state, const real *constant, real *derivative, real *operand, real *scale);

struct Run {
  Right right;
  int states, guards, columns; /* columns of the extrapolation table; the order is twice that */
  real tolerance, fraction;    /* fraction: of the scales */
  real longest;                /* longest step */
  long evaluations, limit;
  const real *constant;
  real operand[GUARDS], scale[GUARDS];
};

enum Outcome { DONE, TOO_LONG, NOT_FINITE };

/*
 * Evaluates the right side. Returns false if it is not finite, or an operand has moved too far since the start of the
 * step. An infinite operand, as of 1 + exp(...), may stay so.
 */
static bool evaluate(struct Run *run, real time, const real *state, real *derivative, bool guarded) {
  real operand[GUARDS], scale[GUARDS];
  run->right(time, state, run->constant, derivative, operand, scale);
  run->evaluations++;
  for (int i = 0; i < run->states; i++)
    if (!isfinite(derivative[i])) return false;
  for (int i = 0; guarded && i < run->guards; i++)
    if (operand[i] != run->operand[i] && !(fabsl(operand[i] - run->operand[i]) <= run->fraction * run->scale[i]))
      return false;
  return true;
}

static bool midpoint(struct Run *run, real time, real h, int steps, const real *state, const real *first, real *end,
                     bool guarded) {
  real before[STATES], now[STATES], slope[STATES], part = h / steps;
  for (int i = 0; i < run->states; i++) {
    before[i] = state[i];
    now[i] = state[i] + part * first[i];
  }
  for (int m = 1; m <= steps; m++) {
    if (!evaluate(run, time + part * m, now, slope, guarded)) return false;
    for (int i = 0; i < run->states; i++) {
      if (m == steps) end[i] = (now[i] + before[i] + part * slope[i]) / 2;
      else {
        real next = before[i] + 2 * part * slope[i];
        before[i] = now[i];
        now[i] = next;
      }
    }
  }
  return true;
}

/* Attempts one step. Returns the error in units of the tolerance, or -1 if the step must be shorter. */
static real attempt(struct Run *run, real time, real h, const real *state, real *result, bool guarded) {
  real first[STATES], table[COLUMNS][STATES], error = 0;
  run->right(time, state, run->constant, first, run->operand, run->scale);
  run->evaluations++;
  int columns = run->columns;
  if (!midpoint(run, time, h, 2 * columns, state, first, table[columns - 1], guarded)) return -1;
  for (int j = 0; j + 1 < columns; j++)
    if (!midpoint(run, time, h, 2 * (j + 1), state, first, table[j], false)) return -1;
  real lower[STATES];
  for (int k = 1; k < columns; k++) {
    if (k == columns - 1) memcpy(lower, table[columns - 1], sizeof lower);
    for (int j = columns - 1; j >= k; j--) {
      real ratio = (real)(j + 1) / (j - k + 1);
      for (int i = 0; i < run->states; i++) table[j][i] += (table[j][i] - table[j - 1][i]) / (ratio * ratio - 1);
    }
  }
  for (int i = 0; i < run->states; i++) {
    result[i] = table[columns - 1][i];
    real size = fmaxl(1, fabsl(state[i])), part = fabsl(result[i] - lower[i]) / (run->tolerance * size);
    if (!(part <= error)) error = part;
  }
  return isfinite(error) ? error : -1;
}

/*
 * Takes one step of at most *step, not beyond end; *step becomes the next length. A step at the limit of rounding is
 * accepted with any error: it ends at a jump.
 */
static enum Outcome step_once(struct Run *run, real *time, real end, real *state, real *step) {
  real shortest = 1e-16L * fmaxl(1, fabsl(end));
  while (run->evaluations <= run->limit) {
    real h = fminl(*step, run->longest), result[STATES];
    bool last = *time + h >= end;
    if (last) h = end - *time;
    real error = attempt(run, *time, h, state, result, h > shortest);
    if (error < 0 && h <= shortest) return NOT_FINITE;
    if (error > 1 && h > shortest) {
      *step = h * fmaxl(0.1L, 0.8L * powl(error, -1.0L / (2 * run->columns - 1)));
      continue;
    }
    if (error < 0) {
      *step = h / 4;
      continue;
    }
    memcpy(state, result, (size_t)run->states * sizeof *state);
    *time = last ? end : *time + h;
    real growth = fminl(3, 0.8L * powl(fmaxl(error, 1e-10L), -1.0L / (2 * run->columns - 1)));
    if (!last || growth < 1) *step = h * growth;
    return DONE;
  }
  return TOO_LONG;
}

static enum Outcome follow(struct Run *run, real time, real end, real *state, real *step) {
  enum Outcome outcome = DONE;
  while (time < end && outcome == DONE) outcome = step_once(run, &time, end, state, step);
  return outcome;
}

/* Called from Python. Returns the outcome, and adds the evaluations to the count. */
int integrate(Right right, int states, int guards, int columns, double tolerance, double fraction, double longest,
              double time, double end, real *state, const real *constant, real *step, long *evaluations, long limit) {
  struct Run run = {.right = right,
                    .states = states,
                    .guards = guards,
                    .columns = columns,
                    .tolerance = tolerance,
                    .fraction = fraction,
                    .longest = longest,
                    .evaluations = *evaluations,
                    .limit = limit,
                    .constant = constant};
  enum Outcome outcome = follow(&run, time, end, state, step);
  *evaluations = run.evaluations;
  return (int)outcome;
}
