#include "fmi/log_categories.h"

#include <string.h>

#include "fmi/check.h"

/* Bits of the set of categories; CATEGORY_ALL stands for all of them. */
enum Category { CATEGORY_EVENTS, CATEGORY_WARNING, CATEGORY_DISCARD, CATEGORY_ERROR, CATEGORY_FATAL, CATEGORY_ALL };

static const char *const categories[] = {
    [CATEGORY_EVENTS] = "logEvents",         [CATEGORY_WARNING] = "logStatusWarning",
    [CATEGORY_DISCARD] = "logStatusDiscard", [CATEGORY_ERROR] = "logStatusError",
    [CATEGORY_FATAL] = "logStatusFatal",     [CATEGORY_ALL] = "logAll",
};
enum { CATEGORY_COUNT = sizeof categories / sizeof *categories };

_Static_assert(ALL_CATEGORIES == (1u << CATEGORY_COUNT) - 1u, "every category");
_Static_assert(PROBLEM_CATEGORIES ==
                   (1u << CATEGORY_WARNING | 1u << CATEGORY_DISCARD | 1u << CATEGORY_ERROR | 1u << CATEGORY_FATAL),
               "what goes wrong");

static enum Category category_of(enum Status status) {
  static const enum Category of[] = {[STATUS_DONE] = CATEGORY_EVENTS,
                                     [STATUS_WARNING] = CATEGORY_WARNING,
                                     [STATUS_DISCARD] = CATEGORY_DISCARD,
                                     [STATUS_ERROR] = CATEGORY_ERROR};
  return of[status];
}

const char *log_category_of(enum Status status) {
  return categories[category_of(status)];
}

unsigned log_wanted(bool has_logger, unsigned chosen) {
  unsigned wanted = 0;
  if (!has_logger) return 0;
  for (int status = STATUS_DONE; status <= STATUS_ERROR; status++)
    if ((chosen & (1u << category_of((enum Status)status) | 1u << CATEGORY_ALL)) != 0) wanted |= 1u << status;
  return wanted;
}

/* Returns the category of this name; CATEGORY_COUNT if there is none. */
static int category_named(const char *name) {
  int category = 0;
  while (category < CATEGORY_COUNT && (name == NULL || strcmp(name, categories[category]) != 0)) category++;
  return category;
}

bool log_choose(struct Instance *instance, const char *const *names, size_t count, unsigned *chosen) {
  if (!check_array(instance, names, count, "categories")) return false;
  for (size_t i = 0; i < count; i++) {
    int category = category_named(names[i]);
    if (category == CATEGORY_COUNT) {
      reject_call(instance, "there is no log category '%s'; expected one of modelDescription.xml, such as logAll",
                  names[i] != NULL ? names[i] : "NULL");
      return false;
    }
    *chosen |= 1u << category;
  }
  return true;
}

void log_escape(const char *message, const char *escaped, char *copy) {
  for (; *message != '\0'; message++) {
    if (strchr(escaped, *message) != NULL) *copy++ = *message;
    *copy++ = *message;
  }
  *copy = '\0';
}
