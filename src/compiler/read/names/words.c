#include "read/names/words.h"

#include <math.h>
#include <string.h>

#include "algebra/functions.h"

const char *const special_functions[] = {"sqrt", "der", "sum", "if", "and", "or", "not", NULL};

enum Operation find_function(const char *name) {
  int operation = 0;
  while (operation < OPERATION_COUNT &&
         (functions[operation].is_internal || strcmp(name, functions[operation].name) != 0))
    operation++;
  return (enum Operation)operation;
}

bool is_function_name(const char *name) {
  size_t i = 0;
  while (special_functions[i] != NULL && strcmp(name, special_functions[i]) != 0) i++;
  return special_functions[i] != NULL || find_function(name) < OPERATION_COUNT;
}

void define_language(struct Scope *scope) {
  scope_set_number(scope, "pi", M_PI);
  for (size_t i = 0; special_functions[i] != NULL; i++) scope_set_number(scope, special_functions[i], NAN);
  for (int operation = 0; operation < OPERATION_COUNT; operation++)
    if (!functions[operation].is_internal) scope_set_number(scope, functions[operation].name, NAN);
}

void reserve_result_names(struct Scope *scope) {
  static const char *const results[] = {
      "kineticEnergy",         "potentialEnergy",     "totalEnergy",    "nonConservativeWork", "solverSteps",
      "derivativeEvaluations", "jacobianEvaluations", "eventIndicator", "solverHandovers",     "events"};
  for (size_t i = 0; i < sizeof results / sizeof *results; i++) scope_set_number(scope, results[i], NAN);
}
