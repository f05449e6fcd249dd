/* Suggests the known name that an unknown one was probably meant to be. */
#pragma once

#include "names/names.h"

/* A search for the name that is most similar to the wanted one. */
struct SimilarName {
  const char *wanted, *best; /* best: NULL for none */
  size_t distance;           /* between best and wanted */
};

/*
 * Considers a known name. It is similar if it differs only in case, or by one typing error, or two from 6 letters on.
 * Names below 3 letters must be equal except for case. The best name has the smallest distance, then the longest common
 * beginning, then the first position in the alphabet.
 */
void similar_consider(struct SimilarName *similar, const char *known);

/* Returns "did you mean 'known'?", or the other remedy if known is NULL. */
const char *suggestion(const char *known, const char *otherwise);

/* Returns the names as a text for messages: the first ones, and the number of the others. */
char *list_of_names(const char *const *names, size_t count);

/* Considers all names of a table. */
void similar_consider_all(struct SimilarName *similar, const struct Names *names);
