#include "stepping/foresight.h"

#include <string.h>

#include "evaluation/evaluate.h"
#include "stepping/steps.h"

/* Whether the next step may begin otherwise than the situation says. */
static bool may_differ(const struct Instance *instance) {
  return instance->foreseen != NULL && instance->situation->mode == MODE_STEP_COMPLETE &&
         instance->situation->changed == CHANGED_VALUES;
}

static void exchange_situations(struct Instance *instance) {
  struct Situation *other = instance->foreseen;
  instance->foreseen = instance->situation;
  instance_use(instance, other);
  instance->prepared_is_stale = true;
}

/* In silence: the step itself will tell what does not go. */
static bool settle_copy(struct Instance *instance) {
  unsigned wanted = instance->log.wanted;
  uint64_t told_singularity = instance->told_singularity;
  instance->log.wanted = 0;
  bool is_settled = evaluate_prepare(instance) == STATUS_DONE && communication_settle(instance);
  instance->log.wanted = wanted;
  instance->told_singularity = told_singularity;
  return is_settled;
}

void foresight_begin(struct Instance *instance) {
  if (!may_differ(instance)) return;
  bool is_new = instance->foresight == FORESIGHT_STALE;
  if (!is_new && instance->foresight == FORESIGHT_NONE) return;
  if (is_new) memcpy(instance->foreseen, instance->situation, situation_size());
  exchange_situations(instance);
  instance->is_foreseeing = true;
  if (!is_new) return;
  instance->foresight = settle_copy(instance) ? FORESIGHT_READY : FORESIGHT_NONE;
  if (instance->foresight == FORESIGHT_READY) return;
  exchange_situations(instance);
  instance->is_foreseeing = false;
}

void foresight_end(struct Instance *instance) {
  if (!instance->is_foreseeing) return;
  int32_t mode = instance->situation->mode;
  exchange_situations(instance);
  instance->is_foreseeing = false;
  instance->situation->mode = mode; /* an error may have ended it */
}
