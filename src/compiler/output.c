#include "output.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/guid.h"
#include "base/memory.h"
#include "base/platform.h"
#include "fmi3_description.h"
#include "licenses.h"
#include "model_description.h"
#include "page/documentation.h"
#include "write/code.h"

enum File { DESCRIPTION, DESCRIPTION_OF_FMI3, TERMINALS, BUILD_DESCRIPTION, DOCUMENTATION, LICENSE, CODE, FILE_COUNT };

/* What names the files of a run that has not come to its end. */
static const char unfinished[] = ".unfinished";

static char *text_of(const struct Program *program, void (*write)(FILE *, const struct Program *)) {
  struct TextStream text;
  write(open_text(&text), program);
  return close_text(&text);
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
  return make_directory(path);
}

static bool write_file(const char *path, const char *text) {
  FILE *file = fopen(path, "wb");
  if (file == NULL) return false;
  bool written = fputs(text, file) >= 0;
  return fclose(file) == 0 && written;
}

/* The last one is what the build looks for: while it is there, all are of one run. */
static const char *const names[FILE_COUNT] = {
    [DESCRIPTION] = "modelDescription.xml",
    [DESCRIPTION_OF_FMI3] = "fmi3/modelDescription.xml",
    [TERMINALS] = "fmi3/terminalsAndIcons.xml",
    [BUILD_DESCRIPTION] = "fmi3/buildDescription.xml",
    [DOCUMENTATION] = "documentation/index.html",
    [LICENSE] = "documentation/licenses/license.txt",
    [CODE] = "system.c",
};

static char *path_of(const char *directory, int file, const char *suffix) {
  return format_text("%s/%s%s", directory, names[file], suffix);
}

static void remove_all(const char *directory, const char *suffix) {
  for (int i = FILE_COUNT - 1; i >= 0; i--) {
    char *path = path_of(directory, i, suffix);
    remove(path);
  }
}

/* A file without a text is left out. */
static bool write_beside(const char *directory, const char *const *texts) {
  bool written = true;
  for (int i = 0; i < FILE_COUNT && written; i++) {
    if (texts[i] == NULL) continue;
    char *path = path_of(directory, i, unfinished);
    written = write_file(path, texts[i]);
  }
  return written;
}

/* Puts what was written beside in the place of an earlier run's files. */
static bool move_in(const char *directory, const char *const *texts) {
  bool moved = true;
  char *mark = path_of(directory, FILE_COUNT - 1, "");
  remove(mark);
  for (int i = 0; i < FILE_COUNT && moved; i++) {
    char *from = path_of(directory, i, unfinished), *to = path_of(directory, i, "");
    remove(to); /* not everywhere does rename do that */
    if (texts[i] != NULL) moved = rename(from, to) == 0;
  }
  return moved;
}

void output_remove(const char *directory) {
  remove_all(directory, "");
}

/* Creates the directory and those in it. */
static bool create_directories(const char *directory) {
  static const char *const inner[] = {"documentation/licenses", "fmi3"};
  bool created = create_directory(directory);
  for (size_t i = 0; i < sizeof inner / sizeof *inner && created; i++)
    created = create_directory(format_text("%s/%s", directory, inner[i]));
  return created;
}

static void write_all(const char *directory, const char *const *texts, struct Diagnostics *diagnostics) {
  if (create_directories(directory) && write_beside(directory, texts) && move_in(directory, texts)) return;
  report_error(diagnostics, 0, "cannot write into '%s': %s; expected a directory that can be written", directory,
               strerror(errno));
  remove_all(directory, unfinished);
}

static bool write_buffers(const struct Program *program, const struct Summary *summary, const char *guid,
                          const xmlBufferPtr *buffers) {
  return model_description_write(buffers[DESCRIPTION], program, guid) &&
         fmi3_description_write(buffers[DESCRIPTION_OF_FMI3], program, guid) &&
         fmi3_terminals_write(buffers[TERMINALS], program) &&
         fmi3_build_description_write(buffers[BUILD_DESCRIPTION], program) &&
         documentation_write(buffers[DOCUMENTATION], program, summary);
}

void output_write(const struct Program *program, const struct Summary *summary, const char *directory,
                  struct Diagnostics *diagnostics) {
  const char *limit = graph_limit(program->model->graph);
  if (limit != NULL) {
    report_error(diagnostics, 0, "the generated code needs %s; expected a smaller system", limit);
    return;
  }
  xmlBufferPtr anonymous = xmlBufferCreate(), buffers[FILE_COUNT];
  const char *texts[FILE_COUNT];
  char guid[GUID_LENGTH];
  char *code = text_of(program, code_write), *licenses = text_of(program, licenses_write);
  for (int i = 0; i < FILE_COUNT; i++) buffers[i] = xmlBufferCreate();
  bool written = model_description_write(anonymous, program, "");
  guid_of((const char *const[]){code, (const char *)xmlBufferContent(anonymous)}, 2, guid);
  char *file = format_text("#define GUID \"%s\"\n%s", guid, code);
  written = written && write_buffers(program, summary, guid, buffers);
  for (int i = 0; i < FILE_COUNT; i++) texts[i] = (const char *)xmlBufferContent(buffers[i]);
  const struct Method *method = program->equations->method;
  if (method != NULL && method->uses_library) texts[BUILD_DESCRIPTION] = NULL;
  texts[LICENSE] = licenses;
  texts[CODE] = file;
  limit = graph_limit(program->model->graph);
  if (limit != NULL)
    report_error(diagnostics, 0, "the description of the FMU needs %s; expected a smaller system", limit);
  else if (written) write_all(directory, texts, diagnostics);
  else report_error(diagnostics, 0, "the output could not be generated; expected more memory");
  xmlBufferFree(anonymous);
  for (int i = 0; i < FILE_COUNT; i++) xmlBufferFree(buffers[i]);
}
