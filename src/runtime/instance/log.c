#include "instance/log.h"

#include <stdarg.h>
#include <stdio.h>

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
