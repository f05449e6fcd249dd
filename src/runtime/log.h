/* Messages to the caller's logger, by category (section 2.1.5). */
#ifndef LOG_H
#define LOG_H

#include "instance.h"

/* Lets compilers that know it check the arguments of a format. */
#ifdef __GNUC__
#define LIKE_PRINTF(place, first) __attribute__((format(printf, place, first)))
#else
#define LIKE_PRINTF(place, first)
#endif

enum LogCategory { LOG_EVENTS, LOG_WARNING, LOG_DISCARD, LOG_ERROR, LOG_FATAL, LOG_ALL, LOG_CATEGORY_COUNT };

enum { ALL_LOG_CATEGORIES = (1u << LOG_CATEGORY_COUNT) - 1u };

/* LOG_CATEGORY_COUNT where there is no category of this name. */
enum LogCategory log_category(const char *name);

/* Sends a message where its category is enabled; '%' and '#' are escaped as the logger expects. */
void log_message(const struct Instance *instance, fmi2Status status, const char *format, ...) LIKE_PRINTF(3, 4);

/* Logs an error and makes the instance refuse to go on until it is reset; returns fmi2Error. */
fmi2Status log_error(struct Instance *instance, const char *format, ...) LIKE_PRINTF(2, 3);

/* A message about an instance that does not exist yet; logger may be NULL. */
void log_instantiation(const fmi2CallbackFunctions *functions, fmi2String name, const char *format, ...)
    LIKE_PRINTF(3, 4);

#endif
