/*
 * Forces in Coulomb friction cones: random problems, whose solutions are checked by the law itself, and closed forms of
 * frictions that share a load.
 */
#include "nonsmooth/cones/interior/cone_interior.h"

#include "expressions.h"

enum { BODIES = 4, CONTACTS = 12, ROWS = 3 * CONTACTS, VELOCITIES = 6 * BODIES };

static struct PlaneMetadata planes[CONTACTS];
static struct SwitchTable switches = {.planes = planes};
static const struct Resolution resolution = {.switches = &switches};
static double delassus[ROWS * ROWS], coefficient[ROWS * ROWS], given[ROWS], rate[ROWS], impulse[ROWS], own_rate[ROWS];
static double work[4 * ROWS * ROWS + 40 * ROWS];
static size_t member[ROWS];

/* Returns a problem of contacts and frictions in planes, each with two rows, with the arrays above. */
static struct ContactImpulses problem(size_t contacts, size_t frictions) {
  size_t rows = contacts + 2 * frictions;
  switches.plane_count = frictions;
  for (size_t i = 0; i < frictions; i++) planes[i].along = 2 * i;
  for (size_t i = 0; i < rows; i++) member[i] = i < contacts ? i : i - contacts;
  memset(coefficient, 0, sizeof coefficient);
  memset(given, 0, sizeof given);
  assert_true(cone_interior_work_count(rows) <= sizeof work / sizeof *work);
  return (struct ContactImpulses){.contact_count = contacts,
                                  .friction_count = 2 * frictions,
                                  .count = rows,
                                  .deciding_count = contacts,
                                  .member = member,
                                  .delassus = delassus,
                                  .coefficient = coefficient,
                                  .given = given};
}

/* Solves a problem. Returns the relative residual. */
static double solve(const struct ContactImpulses *impulses) {
  size_t n = impulses->count;
  for (size_t row = 0; row < n; row++) {
    bool is_first = row < impulses->contact_count || (row - impulses->contact_count) % 2 == 0;
    const double *w = &delassus[row * n + row];
    if (row < impulses->contact_count) own_rate[row] = w[0];
    else if (is_first)
      own_rate[row] = own_rate[row + 1] = 0.5 * (w[0] + w[n + 1]) + hypot(0.5 * (w[0] - w[n + 1]), 0.5 * (w[1] + w[n]));
  }
  struct Cones cones = {.resolution = &resolution,
                        .path = &cone_path,
                        .impulses = impulses,
                        .rate = rate,
                        .impulse = impulse,
                        .scale = own_rate};
  return cone_interior(&cones, 1e-12, true, work);
}

static double rate_behind(const struct ContactImpulses *impulses, size_t row) {
  double sum = rate[row];
  for (size_t j = 0; j < impulses->count; j++) sum += delassus[row * impulses->count + j] * impulse[j];
  return sum;
}

/* Asserts the law for contacts with a friction each, in units of the largest rate. */
static void check_law(const struct ContactImpulses *impulses, double mu) {
  double largest = 0.0, most = 0.0;
  size_t contacts = impulses->contact_count;
  for (size_t i = 0; i < impulses->count; i++) {
    largest = fmax(largest, fmax(fabs(rate[i]), fabs(own_rate[i] * impulse[i])));
    most = fmax(most, fabs(impulse[i]));
  }
  double rounding = 1e-8 * largest;
  for (size_t i = 0; i < contacts; i++) {
    const double *p = &impulse[contacts + 2 * i], limit = mu * impulse[i];
    double u[] = {rate_behind(impulses, contacts + 2 * i), rate_behind(impulses, contacts + 2 * i + 1)};
    double opening = rate_behind(impulses, i), slip = hypot(u[0], u[1]);
    assert_true(impulse[i] >= -1e-8 * most && opening >= -rounding);
    assert_true(fabs(impulse[i] * opening) <= rounding * most);
    assert_true(hypot(p[0], p[1]) <= limit + 1e-8 * most);
    assert_true(fabs(limit * slip + p[0] * u[0] + p[1] * u[1]) <= rounding * most);
  }
}

static double random_share(void) {
  static uint64_t number = 1;
  number = number * 6364136223846793005u + 1442695040888963407u;
  return (double)(number >> 11) / 9007199254740992.0 * 2.0 - 1.0;
}

/* Fills the rows of J of a contact between two bodies, or one and the ground, at random points and in random axes. */
static void fill_contact(double j[ROWS][VELOCITIES], size_t contacts, size_t contact, size_t body, size_t other) {
  double axis[3][3], point[3];
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) axis[i][k] = random_share();
  for (int i = 0; i < 3; i++) { /* Gram and Schmidt */
    double length = 0.0;
    for (int before = 0; before < i; before++) {
      double product = 0.0;
      for (int k = 0; k < 3; k++) product += axis[i][k] * axis[before][k];
      for (int k = 0; k < 3; k++) axis[i][k] -= product * axis[before][k];
    }
    for (int k = 0; k < 3; k++) length += axis[i][k] * axis[i][k];
    for (int k = 0; k < 3; k++) axis[i][k] /= sqrt(length);
  }
  for (size_t side = 0; side < 2; side++) {
    size_t first = 6 * (side == 0 ? body : other);
    if (side == 1 && other == body) break;
    for (int k = 0; k < 3; k++) point[k] = random_share();
    for (size_t i = 0; i < 3; i++) {
      double *row = j[i == 0 ? contact : contacts + 2 * contact + i - 1];
      const double *a = axis[i];
      double arm[] = {point[1] * a[2] - point[2] * a[1], point[2] * a[0] - point[0] * a[2],
                      point[0] * a[1] - point[1] * a[0]};
      for (int k = 0; k < 3; k++) {
        row[first + (size_t)k] = side == 0 ? a[k] : -a[k];
        row[first + 3 + (size_t)k] = side == 0 ? arm[k] : -arm[k];
      }
    }
  }
}

/*
 * Up to twelve contacts, redundant ones among them, at up to four bodies with masses of four decades. Bodies may be
 * wedged between contacts from all sides; for some of these no solution is found.
 */
static void test_random(void **state) {
  (void)state;
  size_t failures = 0;
  for (size_t trial = 0; trial < 1000; trial++) {
    size_t contacts = 1 + trial % CONTACTS, bodies = 1 + trial % BODIES;
    double mu = 0.5 + 0.45 * random_share(), j[ROWS][VELOCITIES] = {{0}}, mass[VELOCITIES], wish[VELOCITIES];
    struct ContactImpulses impulses = problem(contacts, contacts);
    for (size_t i = 0; i < VELOCITIES; i++) {
      mass[i] = pow(10.0, 2.0 * random_share());
      wish[i] = random_share();
    }
    for (size_t i = 0; i < contacts; i++) fill_contact(j, contacts, i, i % bodies, (i + i / bodies) % bodies);
    size_t n = impulses.count;
    for (size_t a = 0; a < n; a++) {
      rate[a] = 0.0;
      for (size_t k = 0; k < VELOCITIES; k++) rate[a] += j[a][k] * wish[k];
      for (size_t b = 0; b < n; b++) {
        delassus[a * n + b] = 0.0;
        for (size_t k = 0; k < VELOCITIES; k++) delassus[a * n + b] += j[a][k] * j[b][k] / mass[k];
      }
    }
    for (size_t i = 0; i < contacts; i++)
      coefficient[2 * i * contacts + i] = coefficient[(2 * i + 1) * contacts + i] = mu;
    if (solve(&impulses) < 1e-10) check_law(&impulses, mu);
    else failures++;
  }
  assert_true(failures < 10);
}

/* A body of mass 2 on frictions of given limits, which are pushed along (3, 4). */
static struct ContactImpulses loaded(size_t count, double load) {
  struct ContactImpulses impulses = problem(0, count);
  size_t n = impulses.count;
  for (size_t i = 0; i < n; i++) {
    given[i] = 1.0 + (double)(i / 2);
    rate[i] = load / 2.0 * (i % 2 == 0 ? 0.6 : 0.8);
    for (size_t k = 0; k < n; k++) delassus[i * n + k] = i % 2 == k % 2 ? 0.5 : 0.0;
  }
  return impulses;
}

/* Four fifths of the sum of all limits: each friction takes some of the load, and keeps a margin. */
static void test_shared_load(void **state) {
  (void)state;
  struct ContactImpulses impulses = loaded(4, 8.0);
  assert_true(solve(&impulses) <= 1e-12);
  double sum[2] = {0.0, 0.0};
  for (size_t i = 0; i < 4; i++) {
    double force = hypot(impulse[2 * i], impulse[2 * i + 1]);
    assert_true(force > 0.4 * given[2 * i] && force < 0.95 * given[2 * i]);
    for (size_t side = 0; side < 2; side++) sum[side] += impulse[2 * i + side];
  }
  assert_true(fabs(sum[0] + 4.8) < 1e-12 && fabs(sum[1] + 6.4) < 1e-12);
}

/* All slide: the limits 1 to 4 leave an acceleration of (12 - 10) / 2. */
static void test_overcome(void **state) {
  (void)state;
  struct ContactImpulses impulses = loaded(4, 12.0);
  assert_true(solve(&impulses) <= 1e-12);
  for (size_t i = 0; i < 4; i++) {
    assert_true(fabs(impulse[2 * i] + 0.6 * given[2 * i]) < 1e-11);
    assert_true(fabs(rate_behind(&impulses, 2 * i) - 0.6) < 1e-11);
    assert_true(fabs(rate_behind(&impulses, 2 * i + 1) - 0.8) < 1e-11);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_random),
      cmocka_unit_test(test_shared_load),
      cmocka_unit_test(test_overcome),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
