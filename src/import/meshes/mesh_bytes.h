/* Numbers in binary mesh files: 32 bits in little-endian order. */
#pragma once

#include <stdint.h>

enum { MESH_NUMBER_SIZE = 4 };

uint32_t mesh_word_at(const char *bytes);
double mesh_number_at(const char *bytes);
