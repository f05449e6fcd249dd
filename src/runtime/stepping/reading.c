#include "stepping/reading.h"

#include "stepping/foresight.h"
#include "stepping/start.h"

void reading_begin(struct Instance *instance, const char *function) {
  start_show(instance, function);
  foresight_begin(instance);
}

void reading_end(struct Instance *instance) {
  foresight_end(instance);
  start_hide(instance);
}
