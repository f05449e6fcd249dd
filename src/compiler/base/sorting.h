/* Numbers in ascending order. */
#pragma once

#include <stddef.h>

void sort_sizes(size_t *sizes, size_t count);
