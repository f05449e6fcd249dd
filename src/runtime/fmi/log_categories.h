/* Categories of messages, which the importer can choose. */
#pragma once

#include "instance/instance.h"

/* Sets of categories. */
enum {
  ALL_CATEGORIES = (1u << 6) - 1u,
  PROBLEM_CATEGORIES = 0x1e /* warnings and errors */
};

/* Returns the name of the category for messages of this status. */
const char *log_category_of(enum Status status);

/* Returns the statuses with messages in these categories, as bits 1 << status; 0 without a logger. */
unsigned log_wanted(bool has_logger, unsigned categories);

/* Adds the categories of these names to a set. False, after logging, if a name is unknown. */
bool log_choose(struct Instance *instance, const char *const *names, size_t count, unsigned *chosen);

/* Copies a message, doubling each of the escaped characters; copy[2 * MESSAGE_LENGTH]. */
void log_escape(const char *message, const char *escaped, char *copy);
