#include "fmi/check.h"

bool check_array(struct Instance *instance, const void *array, size_t count, const char *argument) {
  if (array != NULL || count == 0) return true;
  reject_call(instance, "%s is NULL; expected an array of %zu elements", argument, count);
  return false;
}

const struct ScalarVariable *check_reference(struct Instance *instance, unsigned reference, enum VariableType type) {
  static const char *const types[] = {
      [TYPE_REAL] = "a Real", [TYPE_INTEGER] = "an Integer", [TYPE_BOOLEAN] = "a Boolean"};
  if (reference >= lagrangian.variable_count) {
    reject_call(instance, "the value reference %u is unknown; expected one below %zu", reference,
                lagrangian.variable_count);
    return NULL;
  }
  const struct ScalarVariable *variable = &lagrangian.variables[reference];
  if (variable->type == type) return variable;
  reject_call(instance, "'%s' is %s variable", variable->name, types[variable->type]);
  return NULL;
}
