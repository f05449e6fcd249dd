#include "meshes/mesh_bytes.h"

#include <string.h>

uint32_t mesh_word_at(const char *bytes) {
  uint32_t word = 0;
  for (int i = MESH_NUMBER_SIZE - 1; i >= 0; i--) word = word << 8 | (unsigned char)bytes[i];
  return word;
}

double mesh_number_at(const char *bytes) {
  uint32_t word = mesh_word_at(bytes);
  float number;
  memcpy(&number, &word, sizeof number);
  return (double)number;
}
