#include "output.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "documentation.h"
#include "model_description.h"
#include "write/code.h"
#include "guid.h"
#include "memory.h"

enum { FILE_COUNT = 3 };

static char *code_text(const struct Program *program) {
  char *text = NULL;
  size_t length = 0;
  FILE *file = open_text(&text, &length);
  code_write(file, program);
  fclose(file);
  return text;
}

/* Creates the directory and those above it. */
static bool create_directory(const char *path) {
  char *partial = copy_text(path);
  for (char *slash = strchr(partial + 1, '/'); slash != NULL; slash = strchr(slash + 1, '/')) {
    *slash = '\0';
    mkdir(partial, 0777);
    *slash = '/';
  }
  free(partial);
  struct stat status;
  return mkdir(path, 0777) == 0 || (stat(path, &status) == 0 && S_ISDIR(status.st_mode));
}

static bool write_file(const char *path, const char *text) {
  FILE *file = fopen(path, "w");
  if (file == NULL) return false;
  bool written = fputs(text, file) >= 0;
  return fclose(file) == 0 && written;
}

static const char *const names[FILE_COUNT] = {"system.c", "modelDescription.xml", "documentation/index.html"};

void output_remove(const char *directory) {
  for (int i = 0; i < FILE_COUNT; i++) {
    char *path = format_text("%s/%s", directory, names[i]);
    remove(path);
    free(path);
  }
}

static void write_all(const char *directory, const char *const *texts, struct Diagnostics *diagnostics) {
  char *documentation = format_text("%s/documentation", directory);
  bool written = create_directory(directory) && create_directory(documentation);
  for (int i = 0; i < FILE_COUNT; i++) {
    char *path = format_text("%s/%s", directory, names[i]);
    written = written && write_file(path, texts[i]);
    free(path);
  }
  if (!written)
    report_error(diagnostics, 0, "cannot write into '%s': %s; expected a directory that can be written", directory,
                 strerror(errno));
  free(documentation);
}

void output_write(const struct Program *program, const struct Summary *summary, const char *directory,
                  struct Diagnostics *diagnostics) {
  xmlBufferPtr anonymous = xmlBufferCreate(), description = xmlBufferCreate(), documentation = xmlBufferCreate();
  char guid[GUID_LENGTH];
  char *code = code_text(program);
  bool written = model_description_write(anonymous, program, "");
  guid_of((const char *const[]){code, (const char *)xmlBufferContent(anonymous)}, 2, guid);
  char *file = format_text("#define GUID \"%s\"\n%s", guid, code);
  written = written && model_description_write(description, program, guid) &&
            documentation_write(documentation, program, summary);
  const char *limit = graph_limit(program->model->graph);
  if (limit != NULL)
    report_error(diagnostics, 0, "the description of the FMU needs %s; expected a smaller system", limit);
  else if (written)
    write_all(directory,
              (const char *const[]){file, (const char *)xmlBufferContent(description),
                                    (const char *)xmlBufferContent(documentation)},
              diagnostics);
  else report_error(diagnostics, 0, "the output could not be generated; expected more memory");
  free(code);
  free(file);
  xmlBufferFree(anonymous);
  xmlBufferFree(description);
  xmlBufferFree(documentation);
}
