#include "log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { MESSAGE_LENGTH = 600 };

static const char *const categories[LOG_CATEGORY_COUNT] = {
    [LOG_EVENTS] = "logEvents",     [LOG_WARNING] = "logStatusWarning", [LOG_DISCARD] = "logStatusDiscard",
    [LOG_ERROR] = "logStatusError", [LOG_FATAL] = "logStatusFatal",     [LOG_ALL] = "logAll",
};

enum LogCategory log_category(const char *name) {
  int category = 0;
  while (category < LOG_CATEGORY_COUNT && strcmp(name, categories[category]) != 0) category++;
  return (enum LogCategory)category;
}

static enum LogCategory category_of(fmi2Status status) {
  switch (status) {
  case fmi2Warning: return LOG_WARNING;
  case fmi2Discard: return LOG_DISCARD;
  case fmi2Error: return LOG_ERROR;
  case fmi2Fatal: return LOG_FATAL;
  default: return LOG_EVENTS;
  }
}

/* The message is itself a printf format, and '#' introduces a variable in it (section 2.1.5). */
static void escape(const char *text, char *escaped, size_t size) {
  size_t length = 0;
  for (; *text != '\0' && length + 3 < size; text++) {
    if (*text == '%' || *text == '#') escaped[length++] = *text;
    escaped[length++] = *text;
  }
  escaped[length] = '\0';
}

static void send(fmi2CallbackLogger logger, fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                 const char *format, va_list arguments) {
  char text[MESSAGE_LENGTH], escaped[2 * MESSAGE_LENGTH];
  vsnprintf(text, sizeof text, format, arguments);
  escape(text, escaped, sizeof escaped);
  logger(environment, name, status, categories[category_of(status)], escaped);
}

static void send_enabled(const struct Instance *instance, fmi2Status status, const char *format, va_list arguments) {
  unsigned wanted = 1u << category_of(status) | 1u << LOG_ALL;
  if (instance->logger == NULL || (instance->log_categories & wanted) == 0) return;
  send(instance->logger, instance->environment, instance->name, status, format, arguments);
}

void log_message(const struct Instance *instance, fmi2Status status, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  send_enabled(instance, status, format, arguments);
  va_end(arguments);
}

fmi2Status log_error(struct Instance *instance, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  send_enabled(instance, fmi2Error, format, arguments);
  va_end(arguments);
  instance->situation->mode = MODE_ERROR;
  return fmi2Error;
}

void log_instantiation(const fmi2CallbackFunctions *functions, fmi2String name, const char *format, ...) {
  if (functions == NULL || functions->logger == NULL) return;
  va_list arguments;
  va_start(arguments, format);
  send(functions->logger, functions->componentEnvironment, name != NULL ? name : "", fmi2Error, format, arguments);
  va_end(arguments);
}
