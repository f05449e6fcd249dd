/* The known name that was meant by an unknown one. */
#pragma once

#include "read/names/names.h"

struct Similar {
  const char *wanted, *best; /* best: NULL while nothing is similar */
  size_t distance;           /* of best from wanted */
};

/*
 * Considers a known name, which is similar where upper and lower case alone tell it from the wanted one, or a mistake or
 * two in its typing: a letter too many, too few, wrong, or exchanged with its neighbour. Names of one or two letters have
 * too few for that. Of several, the nearest is best, then the one that begins the same for longer, then the first of the
 * alphabet.
 */
void similar_consider(struct Similar *similar, const char *known);

/* Considers all names of a table. */
void similar_consider_all(struct Similar *similar, const struct Names *names);
