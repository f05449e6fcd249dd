/* Units: parsing, products, and conversion to base units. */
#include <stdio.h>

#include "expressions.h"

static void assert_unit(const char *text, const char *base) {
  struct Dimension dimension;
  const char *problem = NULL;
  if (!unit_parse(text, &dimension, &problem)) fail_msg("'%s': %s", text, problem);
  char *printed = unit_text(dimension);
  assert_string_equal(printed, base);
}

static void test_units_in_base_units(void **state) {
  (void)state;
  assert_unit("1", "1");
  assert_unit("kg.m2/s2", "kg.m2/s2");
  assert_unit("N", "kg.m/s2");
  assert_unit("J", "kg.m2/s2");
  assert_unit("W", "kg.m2/s3");
  assert_unit("N/m", "kg/s2");
  assert_unit("N.m.s/rad", "kg.m2/(s.rad)");
  assert_unit("N/(m.s)", "kg/s3");
  assert_unit("m3/s2", "m3/s2");
  assert_unit("Hz", "1/s");
}

/* The derived units in terms of each other, as in the SI brochure. */
static void test_units_in_each_other(void **state) {
  (void)state;
  static const char *const equal[][2] = {{"Hz", "1/s"}, {"J", "N.m"},  {"W", "J/s"},   {"Pa", "N/m2"},
                                         {"C", "A.s"},  {"V", "W/A"},  {"F", "C/V"},   {"Ohm", "V/A"},
                                         {"S", "A/V"},  {"Wb", "V.s"}, {"T", "Wb/m2"}, {"H", "Wb/A"}};
  for (size_t i = 0; i < sizeof equal / sizeof *equal; i++) {
    struct Dimension dimension;
    const char *problem = NULL;
    if (!unit_parse(equal[i][1], &dimension, &problem)) fail_msg("'%s': %s", equal[i][1], problem);
    char *base = unit_text(dimension);
    assert_unit(equal[i][0], base);
  }
}

static void test_invalid_units(void **state) {
  (void)state;
  static const char *const wrong[] = {"", "km", "m//s", "m/s/s", "N.", "(m", "m)", "m^2", "deg", "m2x", "m999999999"};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    struct Dimension dimension;
    const char *problem = NULL;
    if (unit_parse(wrong[i], &dimension, &problem)) fail_msg("'%s' was taken for a unit", wrong[i]);
    assert_non_null(problem);
  }
}

static void test_agreement(void **state) {
  (void)state;
  struct Dimension torque, energy, force;
  const char *problem;
  assert_true(unit_parse("N.m/rad", &torque, &problem));
  assert_true(unit_parse("J", &energy, &problem));
  assert_true(unit_parse("N", &force, &problem));
  assert_true(dimension_agrees(torque, energy)); /* the radian counts as 1 */
  assert_false(dimension_agrees(force, energy));
  assert_true(dimension_agrees(force, dimension_unknown));
  assert_false(dimension_multiply(force, dimension_unknown, 1.0).known);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_units_in_base_units),
      cmocka_unit_test(test_units_in_each_other),
      cmocka_unit_test(test_invalid_units),
      cmocka_unit_test(test_agreement),
  };
  return cmocka_run_group_tests_name("units", tests, NULL, NULL);
}
