/* Sorting and comparing of sizes. */
#pragma once

#include <stddef.h>

/* Sorts in ascending order. */
void sort_sizes(size_t *sizes, size_t count);

/* Compares two sizes, for qsort(). */
int compare_sizes(const void *first, const void *second);

/* Return the larger and the smaller of two sizes. */
static inline size_t larger(size_t a, size_t b) {
  return a > b ? a : b;
}

/* Returns the smaller of two numbers. */
static inline size_t smaller(size_t a, size_t b) {
  return a < b ? a : b;
}
