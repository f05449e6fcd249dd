#include "meshes/package_path.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/paths.h"

static bool is_there(const char *robot, const char *path) {
  FILE *file = fopen(path_beside_file(robot, path), "rb");
  if (file != NULL) fclose(file);
  return file != NULL;
}

/* Returns the number of folders above that of the file. */
static size_t count_folders(const char *file) {
  const char *path = canonical_path(file);
  size_t count = 0;
  for (; path != NULL && *path != '\0'; path++) count += *path == '/' || *path == '\\';
  return count;
}

/* Returns the text after this beginning; NULL if it begins differently. */
static const char *behind(const char *text, const char *beginning) {
  size_t length = strlen(beginning);
  return strncmp(text, beginning, length) == 0 ? text + length : NULL;
}

char *path_in_package(const char *robot, const char *named) {
  const char *in_package = behind(named, "package://"), *path = behind(named, "file://");
  if (in_package == NULL) {
    char *plain = copy_text(path != NULL ? path : named);
    return is_there(robot, plain) ? plain : NULL;
  }
  const char *rest = strchr(in_package, '/');
  size_t folders = count_folders(robot);
  char *upwards = copy_text("");
  for (size_t i = 0; i <= folders; i++) {
    char *whole = format_text("%s%s", upwards, in_package);
    if (is_there(robot, whole)) return whole;
    char *part = rest != NULL ? format_text("%s%s", upwards, rest + 1) : whole;
    if (is_there(robot, part)) return part;
    upwards = format_text("%s../", upwards);
  }
  return NULL;
}
