/*
 * Motions with contacts, dry friction and events, in long doubles, up to the first change of a mode. The generated
 * source of a system includes reference.c before this file. It defines the sizes N, SIZE (with the rows of
 * constraints), CONTACTS, FRICTIONS and EVENTS. It also defines FIRST_MODE (index of the first mode in the
 * constants), HOLDERS (for each friction its contact, or -1) and parts().
 */
enum {
  PER_CONTACT = 3 + N,  /* gap, its rate, its acceleration for a = 0; its gradient */
  PER_FRICTION = 4 + N, /* velocity, its derivative for a = 0, force, stiction; its gradient */
  AT_TERMS = SIZE * SIZE,
  AT_CONTACTS = AT_TERMS + SIZE,
  AT_FRICTIONS = AT_CONTACTS + CONTACTS * PER_CONTACT,
  AT_EVENTS = AT_FRICTIONS + FRICTIONS * PER_FRICTION,
  AT_SETS = AT_EVENTS + EVENTS,
  AT_GUARDS = AT_SETS + SETS,
  FULL = SIZE + CONTACTS + FRICTIONS,
  SAMPLES = 16,
};

static const int holder[] = HOLDERS;
static const real rounding = 1e-16L, least_jump = 1e-9L;

static const real *closed_of(const real *k) {
  return k + FIRST_MODE;
}
static const real *sliding_of(const real *k) {
  return k + FIRST_MODE + CONTACTS;
}
static const real *active_of(const real *k) {
  return k + FIRST_MODE + CONTACTS + FRICTIONS;
}

/* Solves M a = h + G^T l - W^T f, with rows for the forces l of contacts and f of frictions. */
static void solve_forces(const real *p, const real *k, real *x) {
  static _Thread_local real m[FULL * FULL];
  memset(m, 0, sizeof m);
  for (int i = 0; i < SIZE; i++) {
    for (int j = 0; j < SIZE; j++) m[i * FULL + j] = p[i * SIZE + j];
    x[i] = p[AT_TERMS + i];
  }
  for (int i = 0; i < CONTACTS; i++) {
    const real *contact = p + AT_CONTACTS + i * PER_CONTACT;
    int row = SIZE + i;
    bool holds = closed_of(k)[i] != 0;
    for (int j = 0; j < N; j++) {
      m[j * FULL + row] = -contact[3 + j];
      m[row * FULL + j] = holds ? contact[3 + j] : 0;
    }
    if (!holds) m[row * FULL + row] = 1;
    x[row] = holds ? -contact[2] : 0;
  }
  for (int i = 0; i < FRICTIONS; i++) {
    const real *friction = p + AT_FRICTIONS + i * PER_FRICTION, mode = sliding_of(k)[i];
    int row = SIZE + CONTACTS + i;
    for (int j = 0; j < N; j++) {
      m[j * FULL + row] = friction[4 + j];
      m[row * FULL + j] = mode == 0 ? friction[4 + j] : 0;
    }
    x[row] = mode == 0 ? -friction[1] : holder[i] < 0 ? mode * friction[2] : 0;
    if (mode == 0) continue;
    m[row * FULL + row] = 1;
    if (holder[i] >= 0) m[row * FULL + SIZE + holder[i]] = -mode * friction[2];
  }
  solve(FULL, m, x);
}

void right(real t, const real *y, const real *k, real *d, real *operand, real *scale) {
  real p[PARTS], x[FULL];
  parts(t, y, k, p);
  solve_forces(p, k, x);
  for (int i = 0; i < N; i++) {
    d[i] = y[N + i];
    d[N + i] = x[i];
  }
  memcpy(operand, p + AT_GUARDS, GUARDS_HERE * sizeof *operand);
  memcpy(scale, p + AT_GUARDS + GUARDS_HERE, GUARDS_HERE * sizeof *scale);
}

/* Computes all parts, followed by the accelerations and forces. */
void look(real t, const real *y, const real *k, real *p) {
  parts(t, y, k, p);
  solve_forces(p, k, p + PARTS);
}

/* True if a mode is no longer consistent. */
static bool has_changed(real t, const real *y, const real *k) {
  real p[PARTS + FULL];
  look(t, y, k, p);
  const real *force = p + PARTS + SIZE;
  for (int i = 0; i < CONTACTS; i++) {
    const real *contact = p + AT_CONTACTS + i * PER_CONTACT;
    /* at a kink of the gap, a closed contact is pushed or left behind */
    bool ends = force[i] < -rounding || fabsl(contact[1]) > least_jump;
    if (closed_of(k)[i] != 0 ? ends : contact[0] < -rounding && contact[1] < 0) return true;
  }
  for (int i = 0; i < FRICTIONS; i++) {
    const real *friction = p + AT_FRICTIONS + i * PER_FRICTION, mode = sliding_of(k)[i];
    if (holder[i] >= 0 && closed_of(k)[holder[i]] == 0) continue;
    real stiction = friction[3] * (holder[i] < 0 ? 1 : force[holder[i]]);
    if (mode != 0 ? mode * friction[0] < -rounding : fabsl(force[CONTACTS + i]) > stiction + rounding) return true;
  }
  for (int i = 0; i < EVENTS; i++)
    if ((p[AT_EVENTS + i] > 0) != (active_of(k)[i] != 0)) return true;
  return false;
}

/* Interpolates the state by a cubic Hermite polynomial, which is accurate enough for signs. */
static void interpolate(const real *before, const real *rate_before, const real *behind, const real *rate_behind,
                        real h, real share, real *state) {
  real s = share, r = 1 - share;
  for (int i = 0; i < 2 * N; i++)
    state[i] = r * r * (1 + 2 * s) * before[i] + s * s * (1 + 2 * r) * behind[i] +
               h * s * r * (r * rate_before[i] - s * rate_behind[i]);
}

/*
 * Finds the first change of a mode in a step. Returns the time from the start of the step to just after it, or 0
 * without a change.
 */
static real find_change(struct Run *run, real time, real h, const real *before, const real *behind, real *state) {
  real first[2 * N], last[2 * N], operand[GUARDS], scale[GUARDS], low = 0;
  right(time, before, run->constant, first, operand, scale);
  right(time + h, behind, run->constant, last, operand, scale);
  for (int j = 1; j <= SAMPLES; j++) {
    real high = h * j / SAMPLES;
    interpolate(before, first, behind, last, h, (real)j / SAMPLES, state);
    if (!has_changed(time + high, j == SAMPLES ? behind : state, run->constant)) {
      low = high;
      continue;
    }
    if (attempt(run, time, high, before, state, false) < 0 || !has_changed(time + high, state, run->constant)) continue;
    while (high - low > 4e-20L * fmaxl(1e-2L, fabsl(time))) {
      real middle = (low + high) / 2, at_middle[2 * N];
      if (!(middle > low && middle < high) || attempt(run, time, middle, before, at_middle, false) < 0) break;
      if (has_changed(time + middle, at_middle, run->constant)) {
        high = middle;
        memcpy(state, at_middle, sizeof at_middle);
      } else low = middle;
    }
    return high;
  }
  return 0;
}

/* Called from Python: integrate() up to the first change of a mode; sets *changed, and the time in *reached. */
int advance(int columns, double tolerance, double fraction, double longest, const real *time, const real *end,
            real *state, const real *constant, real *step, long *evaluations, long limit, real *reached, int *changed) {
  struct Run run = {.right = right,
                    .states = 2 * N,
                    .guards = GUARDS_HERE,
                    .columns = columns,
                    .tolerance = tolerance,
                    .fraction = fraction,
                    .longest = longest,
                    .evaluations = *evaluations,
                    .limit = limit,
                    .constant = constant};
  enum Outcome outcome = DONE;
  *reached = *time;
  *changed = 0;
  while (*reached < *end && outcome == DONE && !*changed) {
    real before[2 * N], start = *reached, found[2 * N];
    memcpy(before, state, sizeof before);
    outcome = step_once(&run, reached, *end, state, step);
    if (outcome != DONE) break;
    real way = find_change(&run, start, *reached - start, before, state, found);
    if (way == 0) continue;
    *changed = 1;
    *reached = start + way;
    memcpy(state, found, sizeof found);
  }
  *evaluations = run.evaluations;
  return (int)outcome;
}
