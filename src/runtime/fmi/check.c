#include "fmi/check.h"

bool check_array(struct Instance *instance, const void *array, size_t count, const char *function,
                 const char *argument) {
  if (array != NULL || count == 0) return true;
  log_error(instance, "%s: %s is NULL; expected an array of %zu elements", function, argument, count);
  return false;
}

const struct ScalarVariable *check_reference(struct Instance *instance, unsigned reference, enum VariableType type,
                                             const char *function) {
  static const char *const types[] = {
      [TYPE_REAL] = "a Real", [TYPE_INTEGER] = "an Integer", [TYPE_BOOLEAN] = "a Boolean"};
  if (reference >= lagrangian.variable_count) {
    log_error(instance, "%s: the value reference %u is unknown; expected one below %zu", function, reference,
              lagrangian.variable_count);
    return NULL;
  }
  const struct ScalarVariable *variable = &lagrangian.variables[reference];
  if (variable->type == type) return variable;
  log_error(instance, "%s: '%s' is %s variable", function, variable->name, types[variable->type]);
  return NULL;
}
