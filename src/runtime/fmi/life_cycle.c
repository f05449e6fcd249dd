#include "fmi/life_cycle.h"

bool is_permitted(struct Instance *instance, const struct Permission *permission, const char *function) {
  if ((permission->kinds & IN(instance->kind)) != 0 && (permission->modes & IN(instance->situation->mode)) != 0)
    return true;
  log_error(instance, "%s is not allowed in the state '%s' of an instance for %s", function,
            instance_mode_name(instance), instance->kind == KIND_MODEL_EXCHANGE ? "model exchange" : "co-simulation");
  return false;
}
