#include "stepping/start.h"

#include <string.h>

#include "evaluation/evaluate.h"
#include "instance/initial_state.h"
#include "instance/projection.h"
#include "instance/switching.h"

static bool is_prepared(struct Instance *instance) {
  instance->singular = lagrangian.prepare(instance->parameter, instance->prepared);
  if (instance->singular == 0) instance->prepared_is_stale = false;
  return instance->singular == 0;
}

static bool has_accelerations(struct Instance *instance) {
  struct Point point = evaluate_point(instance);
  return lagrangian.derivatives == NULL || evaluate_derivatives(instance, &point, instance->work);
}

enum Status start_find(struct Instance *instance, const char *function) {
  if (initial_state_check(instance, function) != STATUS_DONE) return STATUS_ERROR;
  if (lagrangian.switching != NULL) lagrangian.switching->guess(instance);
  bool is_ready = is_prepared(instance);
  if (is_ready && lagrangian.projection != NULL && !lagrangian.projection->make_consistent(instance, function))
    return STATUS_ERROR;
  if (is_ready && lagrangian.switching != NULL && !lagrangian.switching->start(instance, function)) return STATUS_ERROR;
  if (is_ready && has_accelerations(instance)) return STATUS_DONE;
  log_singularity(instance, STATUS_ERROR, instance->situation->time);
  return log_error(instance, "%s: the system has no acceleration at its start values", function);
}

/* In other systems the start is what was set. */
static bool moves_to_start(void) {
  return lagrangian.projection != NULL || lagrangian.switching != NULL;
}

static size_t numbers_of_situation(void) {
  return (situation_size() + sizeof(double) - 1) / sizeof(double);
}

size_t start_work_count(void) {
  return moves_to_start() ? 2 * numbers_of_situation() : 0;
}

/* The workspace: the situation with the values that were set, and the one that was found from them. */
static void *given_of(const struct Instance *instance) {
  return instance->start_work;
}

static void *found_of(const struct Instance *instance) {
  return instance->start_work + numbers_of_situation();
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
              "what is read in initialization mode is as it was set, since the simulation cannot start there: %s",
              reason);
  instance->told_impossible_start = true;
}

/* Finds the start without a word, and keeps it; where there is none, the values that were set. */
static void find_silently(struct Instance *instance, const char *function) {
  char reason[MESSAGE_LENGTH] = "";
  struct Log log = instance->log;
  uint64_t told_singularity = instance->told_singularity;
  memcpy(given_of(instance), instance->situation, situation_size());
  instance->log = (struct Log){keep_message, reason, 1u << STATUS_DISCARD | 1u << STATUS_ERROR};
  instance->start_exists = start_find(instance, function) == STATUS_DONE;
  instance->log = log;
  instance->told_singularity = told_singularity;
  if (!instance->start_exists) {
    memcpy(instance->situation, given_of(instance), situation_size());
    tell_impossible_start(instance, reason);
  }
  memcpy(found_of(instance), instance->situation, situation_size());
}

void start_show(struct Instance *instance, const char *function) {
  struct Situation *situation = instance->situation;
  if (!moves_to_start() || situation->mode != MODE_INITIALIZATION) return;
  if (memcmp(situation, given_of(instance), situation_size()) != 0) find_silently(instance, function);
  else memcpy(situation, found_of(instance), situation_size());
  instance->shows_start = true;
  instance->modes_stay = instance->start_exists;
  instance->prepared_is_stale = true;
}

void start_hide(struct Instance *instance) {
  if (!instance->shows_start) return;
  bool failed = instance->situation->mode == MODE_ERROR;
  memcpy(instance->situation, given_of(instance), situation_size());
  if (failed) instance->situation->mode = MODE_ERROR;
  instance->shows_start = instance->modes_stay = false;
  instance->prepared_is_stale = true;
}
