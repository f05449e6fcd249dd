#include "stepping/reading.h"

#include <string.h>

#include "evaluation/evaluate.h"
#include "stepping/start.h"

/* Whether what is told may be other than the situation. */
static bool may_differ(const struct Instance *instance) {
  const struct Situation *situation = instance->situation;
  if (instance->shown == NULL) return false; /* nothing moves what was set */
  if (situation->phase == PHASE_INITIALIZATION) return true;
  return lagrangian.event_laws != NULL && situation->phase == PHASE_STEP_COMPLETE &&
         situation->changed == CHANGED_VALUES;
}

static void exchange_situations(struct Instance *instance) {
  struct Situation *other = instance->shown;
  instance->shown = instance->situation;
  instance_use(instance, other);
  instance->prepared_is_stale = true;
}

/* Keeps the first message. */
static void keep_message(void *receiver, enum Status status, const char *message) {
  char *text = receiver;
  (void)status;
  if (text[0] == '\0') strncat(text, message, MESSAGE_LENGTH - 1);
}

static void tell_impossible_start(struct Instance *instance, const char *reason) {
  if (instance->told_impossible_start) return;
  log_message(instance, STATUS_WARNING,
              "values read in initialization mode are as they were set, since the simulation cannot start there: %s",
              reason);
  instance->told_impossible_start = true;
}

/* Brings the copy to what is told, without a word: what does not go, the function that begins there will tell. */
static void find_silently(struct Instance *instance) {
  char reason[MESSAGE_LENGTH] = "";
  struct Log log = instance->log;
  uint64_t told_singularity = instance->told_singularity;
  bool starts = instance->situation->phase == PHASE_INITIALIZATION;
  instance->log = (struct Log){keep_message, reason, 1u << STATUS_DISCARD | 1u << STATUS_ERROR};
  if (starts) instance->shown_is_found = start_find(instance) == STATUS_DONE;
  else instance->shown_is_found = evaluate_prepare(instance) == STATUS_DONE && start_step(instance);
  instance->log = log;
  instance->told_singularity = told_singularity;
  if (instance->shown_is_found) return;
  memcpy(instance->situation, instance->given, situation_size());
  if (starts) tell_impossible_start(instance, reason);
}

void reading_begin(struct Instance *instance) {
  if (!may_differ(instance)) return;
  bool is_new = memcmp(instance->given, instance->situation, situation_size()) != 0;
  if (is_new) memcpy(instance->given, instance->situation, situation_size());
  if (is_new || !instance->shown_is_found) memcpy(instance->shown, instance->situation, situation_size());
  exchange_situations(instance);
  if (is_new) find_silently(instance);
  instance->modes_stay = instance->shown_is_found;
  instance->prepared_is_stale = true;
  instance->is_reading = true;
}

void reading_end(struct Instance *instance) {
  if (!instance->is_reading) return;
  bool failed = instance->situation->phase == PHASE_ERROR;
  exchange_situations(instance);
  instance->is_reading = instance->modes_stay = false;
  if (!failed) return;
  instance->shown->phase = instance->situation->phase;
  instance->situation->phase = PHASE_ERROR;
}
