#include "names/words.h"

#include <math.h>
#include <string.h>

#include "algebra/functions.h"

const char *const special_functions[] = {"sqrt", "der", "sum", "if", "and", "or", "not", NULL};

const char *const free_functions[] = {"diff", "integral", "floor", "ceil", "round", "mod", "gauss", "uniform", NULL};

/* Names that every system has: first those that expressions can use, then results from FIRST_RESULT on. */
static const char *const values[] = {"pi",
                                     "time",
                                     "kineticEnergy",
                                     "potentialEnergy",
                                     "totalEnergy",
                                     "nonConservativeWork",
                                     "solverSteps",
                                     "derivativeEvaluations",
                                     "jacobianEvaluations",
                                     "eventIndicator",
                                     "solverHandovers",
                                     "events"};
enum { FIRST_RESULT = 2, VALUE_COUNT = sizeof values / sizeof *values };

enum Operation find_function(const char *name) {
  int operation = 0;
  while (operation < OPERATION_COUNT &&
         (functions[operation].is_internal || strcmp(name, functions[operation].name) != 0))
    operation++;
  return (enum Operation)operation;
}

static bool is_among(const char *name, const char *const *list) {
  while (*list != NULL && strcmp(name, *list) != 0) list++;
  return *list != NULL;
}

bool is_function_name(const char *name) {
  return is_among(name, special_functions) || find_function(name) < OPERATION_COUNT;
}

bool is_word(const char *name) {
  size_t i = 0;
  while (i < VALUE_COUNT && strcmp(name, values[i]) != 0) i++;
  return i < VALUE_COUNT || is_function_name(name);
}

void define_language(struct Scope *scope) {
  scope_set_number(scope, "pi", M_PI);
  for (size_t i = 0; special_functions[i] != NULL; i++) scope_set_number(scope, special_functions[i], NAN);
  for (int operation = 0; operation < OPERATION_COUNT; operation++)
    if (!functions[operation].is_internal) scope_set_number(scope, functions[operation].name, NAN);
  for (size_t i = FIRST_RESULT; i < VALUE_COUNT; i++) scope_set_number(scope, values[i], NAN);
}

void words_print(FILE *file) {
  for (int operation = 0; operation < OPERATION_COUNT; operation++)
    if (!functions[operation].is_internal) fprintf(file, "function %s\n", functions[operation].name);
  for (size_t i = 0; special_functions[i] != NULL; i++) fprintf(file, "function %s\n", special_functions[i]);
  for (size_t i = 0; free_functions[i] != NULL; i++) fprintf(file, "function %s\n", free_functions[i]);
  for (size_t i = 0; i < VALUE_COUNT; i++) fprintf(file, "name %s\n", values[i]);
}
