#include "write/function_text.h"

#include <string.h>

bool takes(enum FunctionName name, const char *argument) {
  return strstr(generated_functions[name].arguments, argument) != NULL;
}

void write_head(FILE *file, enum FunctionName name, const char *suffix, size_t operations) {
  const struct GeneratedFunction *function = &generated_functions[name];
  static const char *const types[] = {[RETURNS_NOTHING] = "void", [RETURNS_STATUS] = "int", [RETURNS_VALUE] = "Real"};
  fprintf(file, "/* %s; %zu operations */\nstatic %s %s%s(%s) {\n", function->comment, operations,
          types[function->returned], function->name, suffix, function->arguments);
}
