/*
 * Functions for a page beside those of FMI: creates an instance with callbacks, and collects its messages. FMU_SOURCE
 * is the FMU as one C file; without it, the functions are linked in.
 */
#ifdef FMU_SOURCE
#define FMI2_OVERRIDE_FUNCTION_PREFIX
#include FMU_SOURCE
#else
#include "fmi2.h"
#endif

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __wasm__
#define EXPORT(name) __attribute__((export_name(name)))
#else
#define EXPORT(name) __attribute__((visibility("default")))
#endif

enum { ROOM = 4000 };

static char messages[ROOM]; /* since the last forgetMessages(), one a line; cut off at ROOM */

static void write_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                          fmi2String category, fmi2String format, ...) {
  (void)environment, (void)instance, (void)status, (void)category;
  size_t used = strlen(messages);
  if (used > ROOM - 3) return; /* no room for a line break and the terminating zero */
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(messages + used, ROOM - 1 - used, format, arguments);
  va_end(arguments);
  memcpy(messages + strlen(messages), "\n", 2);
}

static const fmi2CallbackFunctions callbacks = {write_message, calloc, free, NULL, NULL};

EXPORT("instantiate") fmi2Component instantiate(const char *guid) {
  return fmi2Instantiate("live", fmi2CoSimulation, guid, "", &callbacks, fmi2False, fmi2False);
}

EXPORT("messages") char *get_messages(void) {
  return messages;
}

EXPORT("forgetMessages") void forget_messages(void) {
  messages[0] = '\0';
}

EXPORT("allocate") void *get_memory(size_t size) {
  return malloc(size);
}
