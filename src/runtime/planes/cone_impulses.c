/*
 * The law of impacts with Coulomb's cone: of each friction in a plane the impulse has at most the size mu p, has it where it
 * slides behind the impact, opposite to its velocity there, and is what it takes to stick where it does not. One push after the
 * other takes its part at the impulses of the others, until none changes.
 */
#include "planes/cone_impulses.h"

#include <float.h>
#include <math.h>

#include "contacts/planes.h"

enum { PUSH_LIMIT = 50000 };

/* What of its part each push takes: where friction presses a contact together, all of it would go to and fro without end. */
static const double parts[] = {1.0, 0.3, 0.1, 0.03};

/* In units of the largest impulse: changes that are rounding, and what is left of the law's equations where they hold. */
static const double rounded_change = 4.0 * DBL_EPSILON, law_holds = 1e-12;

struct Cones {
  const struct Settlement *settlement;
  const struct Pushes *pushes;
  const double *rate;
  double *impulse;
  double part;            /* that each push takes */
  double largest, change; /* of the impulses in a sweep, as changes of rates */
};

/* The rate of a push behind the impact. */
static double rate_behind(const struct Cones *cones, size_t row) {
  const double *mobility = &cones->pushes->mobility[row * cones->pushes->count];
  double rate = cones->rate[row];
  for (size_t j = 0; j < cones->pushes->count; j++) rate += mobility[j] * cones->impulse[j];
  return rate;
}

/* What the contacts let a friction push. */
static double limit_of(const struct Cones *cones, size_t row) {
  size_t contacts = cones->pushes->contact_count;
  double limit = 0.0;
  for (size_t i = 0; i < contacts; i++)
    limit += cones->pushes->coefficient[(row - contacts) * contacts + i] * cones->impulse[i];
  return limit;
}

/* Takes over an impulse, of which 1 changes its rate by so much. */
static void take(struct Cones *cones, size_t row, double mobility, double whole) {
  double next = cones->impulse[row] + cones->part * (whole - cones->impulse[row]);
  cones->change = fmax(cones->change, mobility * fabs(whole - cones->impulse[row]));
  cones->largest = fmax(cones->largest, mobility * fabs(next));
  cones->impulse[row] = next;
}

static void push_contact(struct Cones *cones, size_t row) {
  double mobility = cones->pushes->mobility[row * cones->pushes->count + row];
  take(cones, row, mobility, fmax(cones->impulse[row] - rate_behind(cones, row) / mobility, 0.0));
}

static void push_along_line(struct Cones *cones, size_t row) {
  double mobility = cones->pushes->mobility[row * cones->pushes->count + row], limit = limit_of(cones, row);
  if (!(mobility > DBL_MIN)) return;
  double next = cones->impulse[row] - rate_behind(cones, row) / mobility;
  take(cones, row, mobility, fmax(-limit, fmin(next, limit)));
}

/* The larger eigenvalue of the mobility along and across. */
static double mobility_in_plane(const struct Pushes *pushes, size_t row) {
  const double *m = &pushes->mobility[row * pushes->count + row];
  double along = m[0], across = m[pushes->count + 1], both = 0.5 * (m[1] + m[pushes->count]);
  return 0.5 * (along + across) + hypot(0.5 * (along - across), both);
}

static void push_in_plane(struct Cones *cones, size_t row) {
  double mobility = mobility_in_plane(cones->pushes, row), limit = limit_of(cones, row);
  if (!(mobility > DBL_MIN)) return;
  double along = cones->impulse[row] - rate_behind(cones, row) / mobility;
  double across = cones->impulse[row + 1] - rate_behind(cones, row + 1) / mobility;
  double size = hypot(along, across), share = size > limit ? limit / size : 1.0;
  take(cones, row, mobility, share * along);
  take(cones, row + 1, mobility, share * across);
}

static void push_all(struct Cones *cones) {
  const struct Pushes *pushes = cones->pushes;
  const struct SwitchTable *switches = cones->settlement->switches;
  cones->change = cones->largest = 0.0;
  for (size_t row = 0; row < pushes->count; row++) {
    if (row < pushes->contact_count) push_contact(cones, row);
    else if (!is_in_plane(switches, pushes->member[row])) push_along_line(cones, row);
    else push_in_plane(cones, row++);
  }
}

/* False where the sweeps come to no end. */
static bool sweep_until_none_changes(struct Cones *cones) {
  for (size_t i = 0; i < cones->pushes->count; i++) cones->impulse[i] = 0.0;
  for (int count = 0; count < PUSH_LIMIT; count++) {
    push_all(cones);
    if (cones->change <= rounded_change * cones->largest) return true;
    if (!isfinite(cones->change)) return false;
  }
  return cones->change <= law_holds * cones->largest;
}

bool cone_impulses_find(const struct Settlement *settlement, const struct Pushes *pushes, const double *rate,
                        double *impulse) {
  struct Cones cones = {.settlement = settlement, .pushes = pushes, .rate = rate, .impulse = impulse};
  bool is_done = false;
  for (size_t i = 0; i < pushes->contact_count; i++)
    if (!(pushes->mobility[i * pushes->count + i] > DBL_MIN)) return false;
  for (size_t i = 0; i < sizeof parts / sizeof *parts && !is_done; i++) {
    cones.part = parts[i];
    is_done = sweep_until_none_changes(&cones);
  }
  return is_done;
}
