/* The table of names, against a plain list of its content. */
#include "base/memory.h"
#include "expressions.h"
#include "names/names.h"

enum { NAMES = 3000 };

static int *number(int value) {
  int *copy = allocate(1, sizeof *copy);
  *copy = value;
  return copy;
}

static void assert_holds(const struct Names *names, const int *expected) {
  size_t count = 0;
  for (int i = 0; i < NAMES; i++) {
    char text[24];
    snprintf(text, sizeof text, "x[%d]", i);
    const int *found = names_find(names, text);
    assert_true((found != NULL) == (expected[i] != 0));
    if (found != NULL) assert_int_equal(*found, expected[i]);
    count += found != NULL;
  }
  assert_int_equal(names->count, count);
}

static void test_names_come_and_go(void **state) {
  (void)state;
  struct Names *names = names_create();
  int expected[NAMES] = {0};
  unsigned seed = 3;
  for (int step = 1; step <= 20000; step++) {
    seed = seed * 1103515245u + 12345u;
    int i = (int)(seed >> 16) % NAMES;
    char text[24];
    snprintf(text, sizeof text, "x[%d]", i);
    bool removes = (seed >> 8) % 3 == 0;
    if (removes) names_remove(names, text);
    else names_set(names, text, number(step));
    expected[i] = removes ? 0 : step;
    if (step % 1000 == 0) assert_holds(names, expected);
  }
  assert_null(names_find(names, "x"));
  assert_null(names_find(names, ""));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_names_come_and_go)};
  return cmocka_run_group_tests_name("names", tests, NULL, NULL);
}
