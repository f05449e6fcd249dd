#include "write/c_text.h"

#include <math.h>

#include "algebra/formula.h"
#include "base/memory.h"

void write_c_number(FILE *file, double value) {
  if (isnan(value)) fputs("NAN", file);
  else if (isinf(value)) fputs(value > 0 ? "INFINITY" : "-INFINITY", file);
  else {
    print_number(file, value);
    if (value == floor(value) && fabs(value) < 1e15) fputs(".0", file);
  }
}

void write_c_string(FILE *file, const char *text) {
  fputc('"', file);
  for (; *text != '\0'; text++) {
    if (*text == '"' || *text == '\\') fputc('\\', file);
    fputc(*text, file);
  }
  fputc('"', file);
}

void write_sizes(FILE *file, const char *type, const char *name, const size_t *sizes, size_t count) {
  fprintf(file, "static const %s %s[] = {", type, name);
  for (size_t i = 0; i < count; i++) fprintf(file, "%s%zu", i == 0 ? "" : i % 16 == 0 ? ",\n    " : ", ", sizes[i]);
  fputs(count == 0 ? "0};\n" : "};\n", file);
}

void write_whole_numbers(FILE *file, const char *name, const int *numbers, size_t count) {
  size_t *sizes = allocate(count, sizeof *sizes);
  for (size_t i = 0; i < count; i++) sizes[i] = (size_t)numbers[i];
  write_sizes(file, "int", name, sizes, count);
}
