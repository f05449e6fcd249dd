#include "output.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/guid.h"
#include "base/memory.h"
#include "base/platform.h"
#include "drawing/icon.h"
#include "drawing/png.h"
#include "drawing/svg.h"
#include "fmi3_description.h"
#include "licenses.h"
#include "model_description.h"
#include "page/documentation.h"
#include "write/code.h"

/* The output files, in the order in which they are written. */
enum File {
  DESCRIPTION,
  DESCRIPTION_OF_FMI3,
  TERMINALS,
  ICON,
  FLANGE_ICON,
  FLANGE_PICTURE,
  BUILD_DESCRIPTION,
  DOCUMENTATION,
  LICENSE,
  PICTURE,
  CODE,
  FILE_COUNT
};

/* The bytes of a file; NULL if it is not written. */
struct FileContent {
  const char *bytes;
  size_t length;
};

/* Suffix of the files of an unfinished run. */
static const char unfinished[] = ".unfinished";

static char *text_of(const struct Program *program, void (*write)(FILE *, const struct Program *)) {
  struct TextStream text;
  write(open_text(&text), program);
  return close_text(&text);
}

/* Creates the directory and its parents. */
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

static bool write_file(const char *path, const struct FileContent *content) {
  FILE *file = fopen(path, "wb");
  if (file == NULL) return false;
  bool written = fwrite(content->bytes, 1, content->length, file) == content->length;
  return fclose(file) == 0 && written;
}

/* CODE comes last: the build waits for it, and while it exists all files are of one run. */
static const char *const names[FILE_COUNT] = {
    [DESCRIPTION] = "modelDescription.xml",
    [DESCRIPTION_OF_FMI3] = "fmi3/modelDescription.xml",
    [TERMINALS] = "fmi3/terminalsAndIcons.xml",
    [ICON] = "fmi3/icon.svg",
    [FLANGE_ICON] = "fmi3/flange.svg",
    [FLANGE_PICTURE] = "fmi3/flange.png",
    [BUILD_DESCRIPTION] = "fmi3/buildDescription.xml",
    [DOCUMENTATION] = "documentation/index.html",
    [LICENSE] = "documentation/licenses/license.txt",
    [PICTURE] = "model.png",
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

static bool write_beside(const char *directory, const struct FileContent *contents) {
  bool written = true;
  for (int i = 0; i < FILE_COUNT && written; i++) {
    if (contents[i].bytes == NULL) continue;
    char *path = path_of(directory, i, unfinished);
    written = write_file(path, &contents[i]);
  }
  return written;
}

/* Renames the unfinished files to replace those of an earlier run. */
static bool move_in(const char *directory, const struct FileContent *contents) {
  bool moved = true;
  char *mark = path_of(directory, FILE_COUNT - 1, "");
  remove(mark);
  for (int i = 0; i < FILE_COUNT && moved; i++) {
    char *from = path_of(directory, i, unfinished), *to = path_of(directory, i, "");
    remove(to); /* rename() does not replace files on all platforms */
    if (contents[i].bytes != NULL) moved = rename(from, to) == 0;
  }
  return moved;
}

void output_remove(const char *directory) {
  remove_all(directory, "");
}

/* Creates the directory and its subdirectories. */
static bool create_directories(const char *directory) {
  static const char *const inner[] = {"documentation/licenses", "fmi3"};
  bool created = create_directory(directory);
  for (size_t i = 0; i < sizeof inner / sizeof *inner && created; i++)
    created = create_directory(format_text("%s/%s", directory, inner[i]));
  return created;
}

static void write_all(const char *directory, const struct FileContent *contents, struct Diagnostics *diagnostics) {
  if (create_directories(directory) && write_beside(directory, contents) && move_in(directory, contents)) return;
  report_error(diagnostics, 0, "cannot write into '%s': %s; expected a directory that can be written", directory,
               strerror(errno));
  remove_all(directory, unfinished);
}

static struct FileContent text_content(const char *text) {
  return (struct FileContent){text, strlen(text)};
}

static bool write_buffers(const struct Program *program, const struct Summary *summary, const char *guid,
                          const struct StartScene *scene, const xmlBufferPtr *buffers) {
  return model_description_write(buffers[DESCRIPTION], program, guid) &&
         fmi3_description_write(buffers[DESCRIPTION_OF_FMI3], program, guid) &&
         fmi3_terminals_write(buffers[TERMINALS], program) &&
         fmi3_build_description_write(buffers[BUILD_DESCRIPTION], program) &&
         documentation_write(buffers[DOCUMENTATION], program, summary, scene);
}

/* Adds the icons; those of a flange if terminals use them. */
static void add_icons(const struct Program *program, const struct StartScene *scene, struct FileContent *contents) {
  struct Drawing icon = icon_of(scene), flange = flange_icon();
  contents[ICON] = text_content(svg_of(&icon));
  contents[PICTURE].bytes = (const char *)png_of(&icon, &contents[PICTURE].length);
  contents[FLANGE_PICTURE].bytes = contents[FLANGE_ICON].bytes = NULL;
  if (fmi3_terminal_count(program) == 0) return;
  contents[FLANGE_ICON] = text_content(svg_of(&flange));
  contents[FLANGE_PICTURE].bytes = (const char *)png_of(&flange, &contents[FLANGE_PICTURE].length);
}

void output_write(const struct Program *program, const struct Summary *summary, const char *directory,
                  struct Diagnostics *diagnostics) {
  const char *limit = graph_limit(program->model->graph);
  if (limit != NULL) {
    report_error(diagnostics, 0, "the generated code needs %s; expected a smaller system", limit);
    return;
  }
  xmlBufferPtr anonymous = xmlBufferCreate(), buffers[FILE_COUNT];
  struct FileContent contents[FILE_COUNT];
  char guid[GUID_LENGTH];
  char *code = text_of(program, code_write), *licenses = text_of(program, licenses_write);
  for (int i = 0; i < FILE_COUNT; i++) buffers[i] = xmlBufferCreate();
  bool written = model_description_write(anonymous, program, "");
  guid_of((const char *const[]){code, (const char *)xmlBufferContent(anonymous)}, 2, guid);
  char *file = format_text("#define GUID \"%s\"\n%s", guid, code);
  struct StartScene scene = start_scene_of(program->model);
  written = written && write_buffers(program, summary, guid, &scene, buffers);
  for (int i = 0; i < FILE_COUNT; i++) contents[i] = text_content((const char *)xmlBufferContent(buffers[i]));
  const struct Method *method = program->equations->method;
  if (method != NULL && method->uses_library) contents[BUILD_DESCRIPTION].bytes = NULL;
  contents[LICENSE] = text_content(licenses);
  contents[CODE] = text_content(file);
  add_icons(program, &scene, contents);
  limit = graph_limit(program->model->graph);
  if (limit != NULL)
    report_error(diagnostics, 0, "the description of the FMU needs %s; expected a smaller system", limit);
  else if (written) write_all(directory, contents, diagnostics);
  else
    report_error(diagnostics, 0,
                 "the output needs more memory than there is, or than 640 MB; expected fewer shapes that touch, frames "
                 "or outputs");
  xmlBufferFree(anonymous);
  for (int i = 0; i < FILE_COUNT; i++) xmlBufferFree(buffers[i]);
}
