/*
 * Forces of contacts at rest, against closed forms. Of those that slide, S = 1 - k J, with J all ones, gives
 * -free/(1 - n k) for n closed contacts.
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

/*
 * A bar of mass 1 and moment of inertia 1 rests on feet at -1, 0 and 1 m, with a load of 1 N at a distance x: three
 * forces, but two equations. Up to x = 2/3 the forces of least norm are 1/3 + x_i x/2. Beyond it that of the first foot
 * would be negative; then it is 0, and the others are 1 - x and x.
 */
static void test_least_forces(void **state) {
  (void)state;
  const double foot[] = {-1.0, 0.0, 1.0}, unit[] = {1.0, 1.0, 1.0};
  for (int i = 0; i <= 9; i++) {
    double x = 0.1 * i;
    struct RestingForces resting = resting_forces_in(block, NULL, 3);
    for (size_t k = 0; k < 3; k++) {
      resting.free[k] = -(1.0 + foot[k] * x);
      for (size_t j = 0; j < 3; j++) resting.s[3 * k + j] = 1.0 + foot[k] * foot[j];
    }
    assert_true(resting_forces_press(&resting, unit));
    for (size_t k = 0; k < 3; k++) {
      double tipping = k == 0 ? 0.0 : k == 1 ? 1.0 - x : x, spread = 1.0 / 3.0 + 0.5 * foot[k] * x;
      assert_true(fabs(resting.found_force[k] - (x > 2.0 / 3.0 ? tipping : spread)) < 1e-7);
      assert_true(fabs(resting.found[k]) < 1e-7);
    }
  }
}

/* Two contacts on opposite sides of a body that both close: no forces keep them open. */
static void test_crushed(void **state) {
  (void)state;
  const double unit[] = {1.0, 1.0};
  struct RestingForces resting = resting_forces_in(block, NULL, 2);
  for (size_t i = 0; i < 2; i++) {
    resting.free[i] = -1.0;
    for (size_t j = 0; j < 2; j++) resting.s[2 * i + j] = i == j ? 1.0 : -1.0;
  }
  assert_false(resting_forces_press(&resting, unit));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_groups),       cmocka_unit_test(test_unstable_forces), cmocka_unit_test(test_many),
      cmocka_unit_test(test_least_forces), cmocka_unit_test(test_crushed),
  };
  return cmocka_run_group_tests_name("resting forces", tests, NULL, NULL);
}
