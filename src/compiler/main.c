/* lagc, the Lagrangian compiler: translates a mechanical system in XML into C and modelDescription.xml. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <libxml/parser.h>

#include "base/memory.h"
#include "base/platform.h"
#include "interface/arrays.h"
#include "interface/listing.h"
#include "mechanics/linearize.h"
#include "mechanics/motion.h"
#include "output.h"
#include "page/equation_lines.h"
#include "program/program.h"
#include "names/words.h"
#include "robots/description/robot_options.h"
#include "read/reader.h"
#include "read/context/value_texts.h"
#include "read/sensitivities.h"
#include "xml/schema.h"

static const char usage[] =
    "usage: lagc SYSTEM.xml -o DIR [--solver METHOD] [--form FORM] [--pull] [--adjoint] [--arrays]\n"
    "            [--along NAME ...] [-D NAME=VALUE ...] [--robot WORD=VALUE ...]\n"
    "       lagc --linearize SYSTEM.xml [--at NAME=VALUE ...] [-D NAME=VALUE ...]\n"
    "       lagc --equations SYSTEM.xml [-D NAME=VALUE ...]\n"
    "       lagc --value NAME=VALUE --unit UNIT\n"
    "       lagc --words | --version\n"
    "\n"
    "Writes system.c, modelDescription.xml, the files of FMI 3.0 (fmi3/), and\n"
    "documentation/index.html into DIR, or prints the matrices A and B of x' = A x + B u\n"
    "at a point (coordinates, velocities, inputs; 0 where not named).\n"
    "\n"
    "  -o DIR           the directory for the files\n"
    "  --solver METHOD  %s in place of the system's own\n"
    "  -D NAME=VALUE    the value of a <constant>, such as 3, 2*pi or 20cm\n"
    "  --robot WORD=VALUE\n"
    "                   an option for the file of a robot, as in an <include>: base=floating, ground=true, "
    "limits=stops,\n"
    "                   friction=sticks, effort=limited, keyframe=NAME, mocap=inputs, self=true,\n"
    "                   tool=LINK\n"
    "  --form FORM      the form of the code: statements or tables; by default by the system's size\n"
    "  --pull           adds inputs of a spring that pulls a body: its stiffness pull.of.BODY; its point on the body, "
    "in the\n"
    "                   body's axes, pull.u, pull.v, pull.w; its other end pull.x, pull.y, pull.z; and\n"
    "                   pull.time, the ratio of its damping to its stiffness\n"
    "  --adjoint        adds a reverse sweep: an adjoint derivative costs the same for any number of knowns\n"
    "  --arrays         writes variables of <for> as arrays in FMI 3.0\n"
    "  --along NAME     adds sensitivities X.by.NAME of coordinates and outputs to a parameter, an input or a start\n"
    "                   value, by the variational equations\n"
    "  --equations      prints the equations of the documentation as lines with tabs, which 'lagrange-fmu show' reads\n"
    "  --at NAME=VALUE  part of the point, such as theta=30deg; several can be joined by commas\n"
    "  --value VALUE    prints the number that 30deg, 20cm, pi/2, ... is in the UNIT\n"
    "  --words          prints the words of the language: function NAME, name NAME or element NAME in each line\n";

/* The arguments of the command line; NULL and 0 for those that are missing. */
struct Arguments {
  const char *system, *directory, *solver, *value, *unit;
  const char **definitions, **robot;
  size_t definition_count, robot_count;
  const char **along;
  size_t along_count;
  char **point;
  size_t point_count;
  enum CodeForm form;
  bool linearize, equations, pull, arrays, words, help, version;
  struct OptionalParts extras;
};

/* Returns the length up to the next comma outside parentheses. */
static size_t length_of_part(const char *text) {
  size_t length = 0;
  for (int depth = 0; text[length] != '\0' && (text[length] != ',' || depth > 0); length++)
    depth += (text[length] == '(') - (text[length] == ')');
  return length;
}

static void append_point(struct Arguments *arguments, const char *text) {
  while (*text != '\0') {
    size_t length = length_of_part(text);
    APPEND(arguments->point, arguments->point_count, format_text("%.*s", (int)length, text));
    text += length + (text[length] == ',');
  }
}

/* Returns false if the arguments are not consistent. */
static bool parse_arguments(int count, char **words, struct Arguments *arguments) {
  for (int i = 1; i < count; i++) {
    const char *word = words[i], *next = i + 1 < count ? words[i + 1] : "";
    bool takes_value = strcmp(word, "-o") == 0 || strcmp(word, "--solver") == 0 || strcmp(word, "-D") == 0 ||
                       strcmp(word, "--at") == 0 || strcmp(word, "--form") == 0 || strcmp(word, "--along") == 0 ||
                       strcmp(word, "--robot") == 0 || strcmp(word, "--value") == 0 || strcmp(word, "--unit") == 0;
    if (takes_value && i + 1 == count) return false;
    if (takes_value) i++;
    if (strcmp(word, "-o") == 0) arguments->directory = next;
    else if (strcmp(word, "--solver") == 0) arguments->solver = next;
    else if (strcmp(word, "--along") == 0) arguments->along[arguments->along_count++] = next;
    else if (strcmp(word, "--robot") == 0) arguments->robot[arguments->robot_count++] = next;
    else if (strcmp(word, "--value") == 0) arguments->value = next;
    else if (strcmp(word, "--unit") == 0) arguments->unit = next;
    else if (strcmp(word, "--at") == 0) append_point(arguments, next);
    else if (strcmp(word, "--linearize") == 0) arguments->linearize = true;
    else if (strcmp(word, "--equations") == 0) arguments->equations = true;
    else if (strcmp(word, "--pull") == 0) arguments->pull = true;
    else if (strcmp(word, "--arrays") == 0) arguments->arrays = true;
    else if (strcmp(word, "--adjoint") == 0) arguments->extras.adjoint = true;
    else if (strcmp(word, "--form") == 0 && strcmp(next, "tables") == 0) arguments->form = TABLES;
    else if (strcmp(word, "--form") == 0 && strcmp(next, "statements") == 0) arguments->form = STATEMENTS;
    else if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) arguments->help = true;
    else if (strcmp(word, "--words") == 0) arguments->words = true;
    else if (strcmp(word, "--version") == 0) arguments->version = true;
    else if (strcmp(word, "-D") == 0) arguments->definitions[arguments->definition_count++] = next;
    else if (word[0] == '-' || arguments->system != NULL) return false;
    else arguments->system = word;
  }
  if (arguments->help || arguments->words || arguments->version) return true;
  if (arguments->value != NULL) return arguments->unit != NULL && strchr(arguments->value, '=') != NULL;
  bool only_reads = arguments->linearize || arguments->equations;
  bool consistent =
      only_reads ? arguments->directory == NULL && arguments->solver == NULL : arguments->directory != NULL;
  if (!arguments->linearize && arguments->point_count > 0) return false;
  return arguments->system != NULL && consistent;
}

static void compile(struct Model *model, const struct Equations *equations, const struct Arguments *arguments,
                    struct Diagnostics *diagnostics) {
  struct Interface *interface = interface_create(model, equations);
  if (arguments->arrays) arrays_find(interface);
  struct Summary *summary = summary_create(model, equations);
  struct Expressions *expressions = expressions_create(model, equations, interface, arguments->extras, diagnostics);
  struct Program *program = expressions != NULL ? program_create(expressions, arguments->form) : NULL;
  if (program != NULL) output_write(program, summary, arguments->directory, diagnostics);
}

static void print_linearization(const struct Model *model, const struct Equations *equations,
                                struct Diagnostics *diagnostics) {
  struct LinearSystem *system = linear_system_of(model, equations, diagnostics);
  if (system != NULL) linear_system_print(model, system);
}

/* Derives the equations of motion, with variational equations if requested. */
static struct Equations *motion_with_sensitivities(struct Model *model, const struct Arguments *arguments,
                                                   struct Diagnostics *diagnostics) {
  model->unrolled = arguments->along_count > 0;
  struct Equations *equations = motion_of(model, diagnostics);
  if (equations == NULL || arguments->along_count == 0) return equations;
  add_sensitivities(model, equations, arguments->along, arguments->along_count, diagnostics);
  model->unrolled = model->constraints.count == 0; /* redundant constraints are detected at run time only */
  return diagnostics->errors == 0 ? motion_of(model, diagnostics) : NULL;
}

static int run(const struct Arguments *arguments) {
  struct Diagnostics diagnostics = {.file = arguments->system};
  struct RobotOptions robot;
  if (!robot_options_parse(arguments->robot, arguments->robot_count, &robot, &diagnostics)) return 1;
  struct ReaderOptions options = {.definitions = arguments->definitions,
                                  .definition_count = arguments->definition_count,
                                  .robot = arguments->robot_count > 0 ? &robot : NULL,
                                  .solver = arguments->solver,
                                  .point = (const char *const *)arguments->point,
                                  .point_count = arguments->point_count,
                                  .pull = arguments->pull,
                                  .linearize = arguments->linearize};
  struct Model *model = model_read(arguments->system, &options, &diagnostics);
  struct Equations *equations = model != NULL ? motion_with_sensitivities(model, arguments, &diagnostics) : NULL;
  if (diagnostics.errors == 0 && arguments->linearize) print_linearization(model, equations, &diagnostics);
  else if (diagnostics.errors == 0 && arguments->equations)
    equations_print(stdout, model, equations, summary_create(model, equations));
  else if (diagnostics.errors == 0) compile(model, equations, arguments, &diagnostics);
  if (diagnostics.errors > 0 && arguments->directory != NULL) output_remove(arguments->directory);
  return diagnostics.errors > 0 ? 1 : 0;
}

/* Prints the words and elements of the language. Returns false on a write error. */
static bool print_words(void) {
  words_print(stdout);
  schema_print_elements(stdout);
  return fflush(stdout) == 0 && ferror(stdout) == 0;
}

/* Prints the number of NAME=VALUE in this unit; returns the status of the process. */
static int print_value(const char *text, const char *unit) {
  const char *value = strchr(text, '=');
  char *name = format_text("%.*s", (int)(value - text), text);
  struct Diagnostics diagnostics = {.file = name};
  double number;
  return !value_read(value + 1, unit, &diagnostics, &number) || printf("%.17g\n", number) < 0;
}

/* Memory limit in bytes; systems within the other limits hardly reach it. */
enum { MEMORY_LIMIT = 640 << 20 };

/* The file in compilation, which the message about missing memory names; before it, the program. */
static const char *file_in_work = "lagc";

static _Noreturn void end_without_memory(void) {
  fprintf(stderr,
          "%s: error: out of memory: the system needs more than there is, or more than 640 MB; expected fewer or "
          "shorter repetitions, tables, frames, constraints or outputs, or fewer shapes that touch, as by "
          "ground=\"LINKS\"\n",
          file_in_work);
  exit(1);
}

/* Drops a message of libxml2, such as of missing memory, which lagc reports in its own words. */
static void drop_message(void *context, const char *format, ...) {
  (void)context, (void)format;
}

int main(int count, char **words) {
  on_memory_failure(end_without_memory);
  xmlSetGenericErrorFunc(NULL, drop_message);
  limit_memory(MEMORY_LIMIT);
  write_plain_lines();
#ifdef SIGXFSZ
  signal(SIGXFSZ, SIG_IGN); /* exceeding the user's file size limit is then reported like a full disk */
#endif
  struct Arguments arguments = {.definitions = allocate((size_t)count, sizeof(char *)),
                                .robot = allocate((size_t)count, sizeof(char *)),
                                .along = allocate((size_t)count, sizeof(char *))};
  int status = 1;
  char *methods = method_names();
  if (!parse_arguments(count, words, &arguments)) fprintf(stderr, usage, methods);
  else if (arguments.help) status = fprintf(stdout, usage, methods) < 0;
  else if (arguments.words) status = !print_words();
  else if (arguments.version) status = puts("lagc " LAGC_VERSION) < 0;
  else if (arguments.value != NULL) status = print_value(arguments.value, arguments.unit);
  else {
    file_in_work = arguments.system;
    status = run(&arguments);
  }
  xmlCleanupParser();
  return status;
}
