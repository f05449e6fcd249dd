#include "instance/log.h"

#include <stdarg.h>
#include <stdio.h>

#include "instance/instance.h"

static void write_arguments(const struct Log *log, enum Status status, const char *format, va_list arguments) {
  char text[MESSAGE_LENGTH];
  if ((log->wanted & 1u << status) == 0) return;
  vsnprintf(text, sizeof text, format, arguments);
  log->write(log->receiver, status, text);
}

void log_write(const struct Log *log, enum Status status, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write_arguments(log, status, format, arguments);
  va_end(arguments);
}

void log_message(const struct Instance *instance, enum Status status, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write_arguments(&instance->log, status, format, arguments);
  va_end(arguments);
}

enum Status log_error(struct Instance *instance, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  write_arguments(&instance->log, STATUS_ERROR, format, arguments);
  va_end(arguments);
  instance->situation->phase = PHASE_ERROR;
  return STATUS_ERROR;
}
