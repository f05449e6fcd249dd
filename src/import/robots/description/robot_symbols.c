#include "robots/description/robot_symbols.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "names/words.h"

/* Returns the code point of the letter of another alphabet at the text, in UTF-8, and its length in bytes. */
static unsigned letter_at(const char *text, size_t *length) {
  unsigned char first = (unsigned char)*text;
  size_t wanted = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  unsigned code = first & (0xFFu >> (wanted + 1));
  for (*length = 1; *length < wanted && ((unsigned char)text[*length] & 0xC0) == 0x80; ++*length)
    code = code << 6 | ((unsigned char)text[*length] & 0x3F);
  return code;
}

char *robot_symbol(const char *name) {
  enum { LETTER_LENGTH = sizeof "u10FFFF" - 1 };
  char *symbol = allocate(LETTER_LENGTH * strlen(name) + 2, 1), *end = symbol;
  if (isdigit((unsigned char)*name)) *end++ = '_';
  for (size_t length = 1; *name != '\0'; name += length, length = 1)
    if ((unsigned char)*name < 0x80) *end++ = isalnum((unsigned char)*name) ? *name : '_';
    else end += snprintf(end, LETTER_LENGTH + 1, "u%04X", letter_at(name, &length));
  return symbol;
}

char *robot_part_symbol(const char *name) {
  static const char *const taken[] = {"base", "g", "tool", "creep_rate", "creep_velocity"};
  bool is_taken = is_word(name);
  for (size_t i = 0; i < sizeof taken / sizeof *taken; i++) is_taken |= strcmp(name, taken[i]) == 0;
  return is_taken ? format_text("%s_", name) : robot_symbol(name);
}
