#include "base/sorting.h"

#include <stdlib.h>

int compare_sizes(const void *first, const void *second) {
  size_t a = *(const size_t *)first, b = *(const size_t *)second;
  return (a > b) - (a < b);
}

void sort_sizes(size_t *sizes, size_t count) {
  qsort(sizes, count, sizeof *sizes, compare_sizes);
}
