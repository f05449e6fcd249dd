#include "output.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "documentation.h"
#include "model_description.h"
#include "write/code.h"
#include "guid.h"
#include "memory.h"
#include "platform.h"

enum { FILE_COUNT = 3 };

/* What names the files of a run that has not come to its end. */
static const char unfinished[] = ".unfinished";

static char *code_text(const struct Program *program) {
  char *text = NULL;
  size_t length = 0;
  FILE *file = open_text(&text, &length);
  code_write(file, program);
  close_text(file, &text, &length);
  return text;
}

/* Creates the directory and those above it. */
static bool create_directory(const char *path) {
  char *partial = copy_text(path);
  for (char *end = first_separator(partial + 1); end != NULL; end = first_separator(end + 1)) {
    char separator = *end;
    *end = '\0';
    make_directory(partial);
    *end = separator;
  }
  free(partial);
  return make_directory(path);
}

static bool write_file(const char *path, const char *text) {
  FILE *file = fopen(path, "wb");
  if (file == NULL) return false;
  bool written = fputs(text, file) >= 0;
  return fclose(file) == 0 && written;
}

/* The last one is what the build looks for: while it is there, all are of one run. */
static const char *const names[FILE_COUNT] = {"modelDescription.xml", "documentation/index.html", "system.c"};

static char *path_of(const char *directory, int file, const char *suffix) {
  return format_text("%s/%s%s", directory, names[file], suffix);
}

static void remove_all(const char *directory, const char *suffix) {
  for (int i = FILE_COUNT - 1; i >= 0; i--) {
    char *path = path_of(directory, i, suffix);
    remove(path);
    free(path);
  }
}

static bool write_beside(const char *directory, const char *const *texts) {
  bool written = true;
  for (int i = 0; i < FILE_COUNT && written; i++) {
    char *path = path_of(directory, i, unfinished);
    written = write_file(path, texts[i]);
    free(path);
  }
  return written;
}

/* Puts what was written beside in the place of an earlier run's files. */
static bool move_in(const char *directory) {
  bool moved = true;
  char *mark = path_of(directory, FILE_COUNT - 1, "");
  remove(mark);
  free(mark);
  for (int i = 0; i < FILE_COUNT && moved; i++) {
    char *from = path_of(directory, i, unfinished), *to = path_of(directory, i, "");
    remove(to); /* not everywhere does rename do that */
    moved = rename(from, to) == 0;
    free(from);
    free(to);
  }
  return moved;
}

void output_remove(const char *directory) {
  remove_all(directory, "");
}

static void write_all(const char *directory, const char *const *texts, struct Diagnostics *diagnostics) {
  char *documentation = format_text("%s/documentation", directory);
  if (!create_directory(directory) || !create_directory(documentation) || !write_beside(directory, texts) ||
      !move_in(directory)) {
    report_error(diagnostics, 0, "cannot write into '%s': %s; expected a directory that can be written", directory,
                 strerror(errno));
    remove_all(directory, unfinished);
  }
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
              (const char *const[]){(const char *)xmlBufferContent(description),
                                    (const char *)xmlBufferContent(documentation), file},
              diagnostics);
  else report_error(diagnostics, 0, "the output could not be generated; expected more memory");
  free(code);
  free(file);
  xmlBufferFree(anonymous);
  xmlBufferFree(description);
  xmlBufferFree(documentation);
}
