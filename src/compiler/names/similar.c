#include "names/similar.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "base/sorting.h"

/* Names of this length or more have no similar names. It bounds the table of distances. LIST_LIMIT: names in a list. */
enum { NAME_LIMIT = 40, LIST_LIMIT = 12 };

static bool is_same_letter(char a, char b) {
  return tolower((unsigned char)a) == tolower((unsigned char)b);
}

/*
 * Returns the optimal string alignment distance of two names. It is the least number of insertions, deletions,
 * replacements and exchanges of neighbouring letters that turn one into the other. No substring is edited twice.
 * Case is ignored. Dynamic programming over prefixes of lengths i and j:
 *
 *   d(i, j) = min(d(i-1, j) + 1, d(i, j-1) + 1, d(i-1, j-1) + [a(i) != b(j)],
 *                 d(i-2, j-2) + 1 if a(i) = b(j-1) and a(i-1) = b(j)).
 *
 * It costs O(m n) for lengths m and n; names of NAME_LIMIT letters or more count as different.
 *
 * F. J. Damerau, A technique for computer detection and correction of spelling errors, Comm. ACM 7 (1964).
 * R. A. Wagner, M. J. Fischer, The string-to-string correction problem, J. ACM 21 (1974).
 */
static size_t edit_distance(const char *a, const char *b) {
  size_t m = strlen(a), n = strlen(b);
  if (m >= NAME_LIMIT || n >= NAME_LIMIT) return NAME_LIMIT;
  size_t distance[NAME_LIMIT][NAME_LIMIT]; /* between the first i letters of a and the first j of b */
  for (size_t i = 0; i <= m; i++) {
    for (size_t j = 0; j <= n; j++) {
      if (i == 0 || j == 0) {
        distance[i][j] = i + j;
        continue;
      }
      size_t best = distance[i - 1][j - 1] + !is_same_letter(a[i - 1], b[j - 1]);
      best = smaller(best, smaller(distance[i - 1][j], distance[i][j - 1]) + 1);
      if (i > 1 && j > 1 && is_same_letter(a[i - 1], b[j - 2]) && is_same_letter(a[i - 2], b[j - 1]))
        best = smaller(best, distance[i - 2][j - 2] + 1);
      distance[i][j] = best;
    }
  }
  return distance[m][n];
}

/* Returns how many typing errors are accepted in a name of this length. */
static size_t allowed_mistakes(const char *name) {
  size_t length = strlen(name);
  return length < 3 ? 0 : length < 6 ? 1 : 2;
}

static size_t common_beginning(const char *a, const char *b) {
  size_t length = 0;
  while (a[length] != '\0' && is_same_letter(a[length], b[length])) length++;
  return length;
}

/* True if a known name is better than the best one so far. */
static bool is_better(const struct SimilarName *similar, const char *known, size_t distance) {
  if (similar->best == NULL) return true;
  if (distance != similar->distance) return distance < similar->distance;
  size_t same = common_beginning(similar->wanted, known), best = common_beginning(similar->wanted, similar->best);
  return same != best ? same > best : strcmp(known, similar->best) < 0;
}

void similar_consider(struct SimilarName *similar, const char *known) {
  size_t distance = edit_distance(similar->wanted, known);
  size_t allowed = smaller(allowed_mistakes(similar->wanted), allowed_mistakes(known));
  if (distance > allowed || !is_better(similar, known, distance)) return;
  similar->best = known;
  similar->distance = distance;
}

void similar_consider_all(struct SimilarName *similar, const struct Names *names) {
  for (size_t i = 0; i < names->capacity; i++)
    if (names->slots[i].text != NULL) similar_consider(similar, names->slots[i].text);
}

const char *suggestion(const char *known, const char *otherwise) {
  return known != NULL ? format_text("did you mean '%s'?", known) : otherwise;
}

char *list_of_names(const char *const *names, size_t count) {
  char *list = copy_text("");
  size_t shown = count > LIST_LIMIT ? LIST_LIMIT - 1 : count;
  for (size_t i = 0; i < shown; i++) list = format_text("%s%s%s", list, i > 0 ? ", " : "", names[i]);
  return shown < count ? format_text("%s and %zu others", list, count - shown) : list;
}
