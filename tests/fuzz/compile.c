/*
 * Runs lagc on arbitrary bytes, for libFuzzer (scripts/fuzz). It must end with files or messages, without crashes,
 * leaks or long work.
 */
#define _GNU_SOURCE /* memfd_create */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include <libxml/tree.h>

#include "drawing/icon.h"
#include "drawing/png.h"
#include "drawing/svg.h"
#include "page/documentation.h"
#include "mechanics/motion.h"
#include "base/memory.h"
#include "interface/arrays.h"
#include "interface/listing.h"
#include "model_description.h"
#include "program/program.h"
#include "read/reader.h"
#include "write/code.h"

int LLVMFuzzerInitialize(int *count, char ***words);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void write_texts(const struct Program *program, const struct Summary *summary) {
  struct TextStream code;
  FILE *file = open_text(&code);
  code_write(file, program);
  close_text(&code);
  xmlBufferPtr buffer = xmlBufferCreate();
  struct StartScene scene = start_scene_of(program->model);
  struct Drawing icon = icon_of(&scene);
  bool written = model_description_write(buffer, program, "") && documentation_write(buffer, program, summary, &scene);
  if (!written) abort();
  size_t length;
  svg_of(&icon);
  png_of(&icon, &length);
  xmlBufferFree(buffer);
}

static void compile(const struct Model *model, const struct Equations *equations, struct Diagnostics *diagnostics) {
  struct Interface *interface = interface_create(model, equations);
  arrays_find(interface);
  struct Summary *summary = summary_create(model, equations);
  struct Expressions *expressions =
      expressions_create(model, equations, interface, (struct OptionalParts){0}, diagnostics);
  struct Program *program = expressions != NULL ? program_create(expressions, (enum CodeForm){0}) : NULL;
  if (program != NULL) write_texts(program, summary);
}

static void compile_file(const char *path) {
  struct Diagnostics diagnostics = {.file = path};
  struct ReaderOptions options = {0};
  struct Model *model = model_read(path, &options, &diagnostics);
  if ((model == NULL) != (diagnostics.errors > 0)) abort();
  struct Equations *equations = model != NULL ? motion_of(model, &diagnostics) : NULL;
  if (diagnostics.errors == 0) compile(model, equations, &diagnostics);
}

int LLVMFuzzerInitialize(int *count, char ***words) {
  (void)count;
  (void)words;
  stderr = fopen("/dev/null", "w"); /* the sanitizers write to the descriptor, so their reports remain */
  return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  int file = memfd_create("system.xml", 0);
  char path[64];
  if (file < 0 || write(file, data, size) != (ssize_t)size) abort();
  snprintf(path, sizeof path, "/proc/self/fd/%d", file);
  compile_file(path);
  release_all();
  close(file);
  return 0;
}
