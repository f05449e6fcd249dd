/* Numbers in ascending order. */
#ifndef SORTING_H
#define SORTING_H

#include <stddef.h>

void sort_sizes(size_t *sizes, size_t count);

#endif
