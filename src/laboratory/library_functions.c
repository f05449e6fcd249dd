#include "library_functions.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "bounded_functions.h"
#include "random_numbers.h"

static const struct {
  const char *name;
  FunctionOfOne *function;
} functions_of_one[] = {{"sin", sin},
                        {"cos", cos},
                        {"tan", tan},
                        {"asin", asin},
                        {"acos", acos},
                        {"atan", atan},
                        {"sinh", sinh},
                        {"cosh", cosh},
                        {"tanh", tanh},
                        {"asinh", asinh},
                        {"exp", exp},
                        {"acosh", acosh},
                        {"atanh", atanh},
                        {"fabs", fabs},
                        {"log", log},
                        {"floor", floor},
                        {"logistic", logistic},
                        {"softplus", softplus},
                        {"sech", sech},
                        {"log_cosh", log_cosh},
                        {"capped_exp", capped_exp},
                        {"capped_exp_slope", capped_exp_slope}};

static const struct {
  const char *name;
  FunctionOfTwo *function;
} functions_of_two[] = {{"pow", pow},
                        {"atan2", atan2},
                        {"fmin", fmin},
                        {"fmax", fmax},
                        {"random_uniform", random_uniform},
                        {"random_gauss", random_gauss}};

FunctionOfOne *function_of_one(const char *name) {
  for (size_t i = 0; i < sizeof functions_of_one / sizeof *functions_of_one; i++)
    if (strcmp(functions_of_one[i].name, name) == 0) return functions_of_one[i].function;
  return NULL;
}

FunctionOfTwo *function_of_two(const char *name) {
  for (size_t i = 0; i < sizeof functions_of_two / sizeof *functions_of_two; i++)
    if (strcmp(functions_of_two[i].name, name) == 0) return functions_of_two[i].function;
  return NULL;
}
