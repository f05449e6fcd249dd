#include "laboratory.h"

#include <string.h>

#include <libxml/tree.h>

#include "assembly.h"
#include "base/guid.h"
#include "base/memory.h"
#include "interface/arrays.h"
#include "interface/listing.h"
#include "mechanics/motion.h"
#include "model_description.h"
#include "page/documentation.h"
#include "program/program.h"
#include "read/reader.h"
#include "robots/description/robot_options.h"

static const char *description_text, *documentation_text;

static const char *text_in(const xmlBufferPtr buffer) {
  return (const char *)xmlBufferContent(buffer);
}

/* Creates the descriptions and the GUID. Returns false if memory is exhausted. */
static bool describe(const struct Program *program, const struct Summary *summary, char *guid) {
  xmlBufferPtr anonymous = xmlBufferCreate(), description = xmlBufferCreate(), page = xmlBufferCreate();
  struct StartScene scene = start_scene_of(program->model);
  if (!model_description_write(anonymous, program, "")) return false;
  guid_of((const char *const[]){text_in(anonymous)}, 1, guid);
  bool written =
      model_description_write(description, program, guid) && documentation_write(page, program, summary, &scene);
  description_text = text_in(description);
  documentation_text = text_in(page);
  xmlBufferFree(anonymous);
  return written;
}

static void make(const struct Program *program, const struct Summary *summary, struct Diagnostics *diagnostics) {
  char *guid = allocate(GUID_LENGTH, 1);
  bool described = describe(program, summary, guid);
  const char *limit = graph_limit(program->model->graph);
  const char *missing = limit == NULL && described ? assemble(program, guid) : NULL;
  if (limit != NULL) report_error(diagnostics, 0, "the system needs %s; expected a smaller one", limit);
  else if (!described) report_error(diagnostics, 0, "the system cannot be described; expected more memory");
  else if (missing != NULL)
    report_error(diagnostics, 0,
                 "the method '%s' is not available here; expected <solver method=\"auto\"/>, or taylor or radau",
                 missing);
}

/* Sets the options from texts such as "base=floating", one a line. Returns false after reporting a wrong one. */
static bool parse_options(const char *lines, struct RobotOptions *options, struct Diagnostics *diagnostics) {
  const char *words[ROBOT_WORDS];
  size_t count = 0;
  for (size_t length; *lines != '\0' && count < ROBOT_WORDS; lines += length + (lines[length] != '\0')) {
    length = strcspn(lines, "\n");
    words[count++] = format_text("%.*s", (int)length, lines);
  }
  return robot_options_parse(words, count, options, diagnostics);
}

int derive(const char *path, int pull, const char *robot) {
  struct Diagnostics diagnostics = {.file = path};
  struct RobotOptions robot_options;
  if (!parse_options(robot, &robot_options, &diagnostics)) return 1;
  struct ReaderOptions options = {.pull = pull != 0, .robot = *robot != '\0' ? &robot_options : NULL};
  struct Model *model = model_read(path, &options, &diagnostics);
  struct Equations *equations = model != NULL ? motion_of(model, &diagnostics) : NULL;
  if (diagnostics.errors > 0) return 1;
  struct Interface *interface = interface_create(model, equations);
  arrays_find(interface);
  struct Summary *summary = summary_create(model, equations);
  struct Expressions *expressions =
      expressions_create(model, equations, interface, (struct OptionalParts){0}, &diagnostics);
  if (expressions != NULL) make(program_create(expressions, ALL_TABLES), summary, &diagnostics);
  return diagnostics.errors > 0 ? 1 : 0;
}

const char *model_description(void) {
  return description_text;
}

const char *documentation(void) {
  return documentation_text;
}
