#include "base/paths.h"

#include <stdlib.h>

#include "base/memory.h"
#include "base/platform.h"

char *canonical_path(const char *path) {
  char *resolved = resolve_path(path), *copy = resolved != NULL ? copy_text(resolved) : NULL;
  free(resolved);
  return copy;
}

const char *file_name(const char *path) {
  const char *end = last_separator(path);
  return end != NULL ? end + 1 : path;
}

char *path_beside_file(const char *present, const char *named) {
  const char *end = last_separator(present);
  if (is_absolute(named) || end == NULL) return copy_text(named);
  return format_text("%.*s/%s", (int)(end - present), present, named);
}
