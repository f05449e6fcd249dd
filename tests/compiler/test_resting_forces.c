/*
 * Forces of sliding contacts, against closed forms: S = 1 - k J, with J all ones, gives -free/(1 - n k) for n closed
 * contacts.
 */
#include "nonsmooth/contacts/resting_forces.h"

#include "expressions.h"

enum { MOST = 16 };

static double block[4 * MOST * MOST + 21 * MOST + MOST * (2 * MOST + 3)];

/* Returns groups of `size` contacts, with free accelerations of -1, and k for each group. */
static struct RestingForces groups(size_t count, size_t size, const double *k) {
  assert_true(resting_forces_bytes(NULL, count) <= sizeof block);
  struct RestingForces resting = resting_forces_in(block, NULL, count);
  for (size_t i = 0; i < count; i++) {
    resting.free[i] = -1.0;
    for (size_t j = 0; j < count; j++)
      resting.s[i * count + j] = (i == j ? 1.0 : 0.0) - (i / size == j / size ? k[i / size] : 0.0);
  }
  return resting;
}

static void test_groups(void **state) {
  (void)state;
  struct RestingForces resting = groups(16, 8, (double[]){0.01, 0.02});
  assert_int_equal(resting_forces_solve(&resting, false), ONE_MOTION);
  for (size_t i = 0; i < 16; i++) {
    assert_true(fabs(resting.found_force[i] - (i < 8 ? 1.0 / 0.92 : 1.0 / 0.84)) < 1e-14);
    assert_true(fabs(resting.found[i]) < 1e-14);
  }
}

/* With k = 0.2 and free = 1, all 8 contacts of a group or none may press: F = 1/0.6, or 0. Compliance leads from the first to the second. */
static void test_unstable_forces(void **state) {
  (void)state;
  struct RestingForces resting = groups(8, 8, (double[]){0.2});
  assert_int_equal(resting_forces_solve(&resting, false), NO_MOTION);
  for (size_t i = 0; i < 8; i++) resting.free[i] = 1.0;
  for (int presses = 0; presses < 2; presses++) {
    for (size_t i = 0; i < 8; i++) resting.present[i] = presses ? 1.0 / 0.6 : 0.0;
    assert_int_equal(resting_forces_solve(&resting, true), presses ? OTHER_MOTION : ONE_MOTION);
    for (size_t i = 0; i < 8; i++) assert_true(resting.found_force[i] == 0.0 && resting.found[i] == 1.0);
  }
}

static void test_many(void **state) {
  (void)state;
  struct RestingForces resting = groups(14, 14, (double[]){0.02});
  resting.free[3] = resting.free[5] = 10.0; /* these separate, and 12 stay closed */
  assert_int_equal(resting_forces_solve(&resting, false), ONE_MOTION);
  for (size_t i = 0; i < 14; i++) {
    bool parts = i == 3 || i == 5;
    assert_true(fabs(resting.found_force[i] - (parts ? 0.0 : 1.0 / 0.76)) < 1e-12);
    assert_true(fabs(resting.found[i] - (parts ? 10.0 - 0.24 / 0.76 : 0.0)) < 1e-12);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_groups),
      cmocka_unit_test(test_unstable_forces),
      cmocka_unit_test(test_many),
  };
  return cmocka_run_group_tests_name("resting forces", tests, NULL, NULL);
}
