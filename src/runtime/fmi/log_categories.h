/* The categories of messages, which an interface's caller can choose from. */
#ifndef LOG_CATEGORIES_H
#define LOG_CATEGORIES_H

#include "instance/instance.h"

/* Sets of categories. */
enum {
  ALL_CATEGORIES = (1u << 6) - 1u,
  PROBLEM_CATEGORIES = 0x1e /* what goes wrong */
};

/* The name of the category of a message with this status. */
const char *log_category_of(enum Status status);

/* Which statuses, as bits 1 << status, have messages in these categories, for a caller who has a logger. */
unsigned log_wanted(bool has_logger, unsigned categories);

/* Adds the categories with these names to a set. False after logging a name that there is not. */
bool log_choose(struct Instance *instance, const char *const *names, size_t count, unsigned *chosen);

/* Copies a message with each of the escaped characters doubled; copy[2 * MESSAGE_LENGTH]. */
void log_escape(const char *message, const char *escaped, char *copy);

#endif
