#include "instance/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "instance/instance.h"

/* Formats and writes a message. function: printed before it; NULL for none. */
static void write_arguments(const struct Log *log, enum Status status, const char *function, const char *format,
                            va_list arguments) {
  char text[MESSAGE_LENGTH];
  if ((log->wanted & 1u << status) == 0) return;
  int length = function != NULL ? snprintf(text, sizeof text, "%s: ", function) : 0;
  vsnprintf(text + length, sizeof text - (size_t)length, format, arguments);
  log->write(log->receiver, status, text);
}

void log_keep_first(void *receiver, enum Status status, const char *message) {
  char *text = receiver;
  (void)status;
  if (text[0] == '\0') strncat(text, message, MESSAGE_LENGTH - 1);
}

static void defer_discards(void *receiver, enum Status status, const char *message) {
  struct DeferredLog *deferred = receiver;
  if (status == STATUS_DISCARD) log_keep_first(deferred->text, status, message);
  else deferred->log.write(deferred->log.receiver, status, message);
}

void log_defer(struct Instance *instance, struct DeferredLog *deferred) {
  deferred->log = instance->log;
  deferred->text[0] = '\0';
  instance->log = (struct Log){defer_discards, deferred, deferred->log.wanted};
}

void log_release(struct Instance *instance, const struct DeferredLog *deferred) {
  instance->log = deferred->log;
}

void log_write_deferred(const struct Instance *instance, const struct DeferredLog *deferred) {
  if (deferred->text[0] != '\0') log_message(instance, STATUS_DISCARD, "%s", deferred->text);
}

void log_write(const struct Log *log, enum Status status, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write_arguments(log, status, NULL, format, arguments);
  va_end(arguments);
}

void log_message(const struct Instance *instance, enum Status status, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write_arguments(&instance->log, status, NULL, format, arguments);
  va_end(arguments);
}

enum Status log_error(struct Instance *instance, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write_arguments(&instance->log, STATUS_ERROR, NULL, format, arguments);
  va_end(arguments);
  instance->fmu_state->phase = PHASE_ERROR;
  return STATUS_ERROR;
}

enum Status reject_call(struct Instance *instance, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write_arguments(&instance->log, STATUS_ERROR, instance->function, format, arguments);
  va_end(arguments);
  instance->fmu_state->phase = PHASE_ERROR;
  return STATUS_ERROR;
}

enum Status discard_call(const struct Instance *instance, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write_arguments(&instance->log, STATUS_DISCARD, instance->function, format, arguments);
  va_end(arguments);
  return STATUS_DISCARD;
}
