#include "check.h"

bool check_array(struct Instance *instance, const void *array, size_t count, const char *function,
                 const char *argument) {
  if (array != NULL || count == 0) return true;
  log_error(instance, "%s: %s is NULL; expected an array of %zu elements", function, argument, count);
  return false;
}

const struct ScalarVariable *check_reference(struct Instance *instance, unsigned reference, bool integer,
                                             const char *function) {
  if (reference >= lagrangian.variable_count) {
    log_error(instance, "%s: the value reference %u is unknown; expected one below %zu", function, reference,
              lagrangian.variable_count);
    return NULL;
  }
  const struct ScalarVariable *variable = &lagrangian.variables[reference];
  if ((variable->kind == VARIABLE_STATISTIC) == integer) return variable;
  log_error(instance, "%s: '%s' is %s variable", function, variable->name, integer ? "a Real" : "an Integer");
  return NULL;
}
