/* Attributes of XML elements as strings, numbers, names and expressions. */
#pragma once

#include "model/model.h"
#include "read/context/reader_options.h"
#include "read/expressions/parser.h"
#include "read/names/pieces_of_functions.h"
#include "read/xml/nodes.h"

/* Each pass uses the names that the ones before it made known, wherever in the file they stand. */
enum Pass { DECLARATIONS, DEFINITIONS, POSITIONS, EXPRESSIONS };

struct Dissipation {
  Node node;
  long line;
};

/* What should not be below 0 at the start values. */
struct Expectation {
  Node node;
  long line;
  const char *what;
  bool is_required, is_size; /* a size: above 0, and finite */
};

struct Source;
struct Loop;

/* An element of the document as often as it is repeated and included. */
struct Occurrence {
  xmlNodePtr node;
  struct Source *source;    /* in which it stands */
  const struct Loop *loops; /* the innermost <for> around it, see definitions.h; NULL for none */
  size_t number; /* what it declares among those of its kind: the first coordinate, constraint, contact, ... */
};

struct Reader {
  struct Model *model;
  struct Scope *scope;
  struct Definitions *definitions;
  struct Names *bodies;         /* name -> struct NamedBody */
  struct Names *frames;         /* name -> size_t, its place among the model's */
  struct Names *spatial_points; /* name -> struct SpatialPoint, see frames.h */
  struct Names *meshes;         /* path and scale -> struct Mesh, see shape_meshes.h; NULL before the first one */
  struct Source *source;        /* the file being read */
  struct Includes *includes;    /* all files that are included */
  struct Diagnostics *diagnostics;
  const struct ReaderOptions *options;
  bool *definition_used;
  bool has_solver, has_experiment;
  struct Dissipation *dissipations; /* each <dissipation> that was read */
  size_t dissipation_count;
  struct Expectation *expectations;
  size_t expectation_count;
  Node *undisplaced; /* one node a symbol: what replaces it where nothing is displaced; NULL until it is asked for */
  size_t undisplaced_count;
  struct Occurrence *occurrences; /* all elements, without <for> and <include> */
  size_t occurrence_count;
  struct Occurrence *present; /* the one being read */
};

/* Reports an error in the line of an element. */
void report_at(const struct Reader *reader, xmlNodePtr node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The kinds of symbols that may stand in a place, as in struct Place; what else must hold there is in a bit beyond. */
#define KIND(kind) (1u << (kind))

enum {
  IN_MASS = KIND(PARAMETER),
  IN_DRIVE = KIND(PARAMETER) | KIND(MODE) | KIND(TIME) | KIND(INPUT),
  IN_INERTIA = KIND(PARAMETER) | KIND(MODE) | KIND(COORDINATE) | KIND(TIME) | KIND(DISPLACEMENT),
  WITH_RATES = 1 << 30, /* of the inputs, which must be there: what depends on them is moved */
  IN_POSITION = IN_INERTIA | KIND(INPUT) | WITH_RATES,
  IN_ENERGY = IN_POSITION | KIND(VELOCITY),
  /* which derivatives of inputs it needs depends on whether it is one of velocities: see constraint_checks.h */
  IN_CONSTRAINT = KIND(PARAMETER) | KIND(MODE) | KIND(COORDINATE) | KIND(TIME) | KIND(VELOCITY) | KIND(INPUT),
  IN_POTENTIAL = IN_ENERGY | KIND(STATE),
  IN_FORCE = IN_INERTIA | KIND(VELOCITY) | KIND(STATE) | KIND(INPUT),
  IN_RATE = (IN_FORCE | KIND(ACCELERATION) | KIND(REACTION)) & ~KIND(DISPLACEMENT),
  IN_OUTPUT = IN_FORCE | KIND(ACCELERATION) | KIND(REACTION) | CONTACT_STATE,
};

/* An expression in the line of an element, which may depend on these kinds of symbols. */
struct Place place_at(xmlNodePtr node, const char *what, unsigned kinds);

/* True and *value set where the attribute is present and right; reports an error where it is not right. */
bool number_attribute(struct Reader *reader, xmlNodePtr node, const char *name, double *value);

/* The same of a text from the node that the attribute's name stands for in messages. */
bool number_in(struct Reader *reader, xmlNodePtr node, const char *name, const char *text, double *value);

/*
 * The full name in an attribute, its index worked out, of what the element declares; NULL where missing or after an
 * error.
 */
char *name_attribute(struct Reader *reader, xmlNodePtr node, const char *name);

/* The same of what is declared elsewhere, perhaps in an included file. */
char *reference_attribute(struct Reader *reader, xmlNodePtr node, const char *name);

/* An expression in an attribute; true where present. kinds as in struct Place. */
bool expression_attribute(struct Reader *reader, xmlNodePtr node, const char *name, unsigned kinds,
                          struct Quantity *value);

/* The node where nothing is displaced; reports where it has no finite value there. */
Node without_displacements(struct Reader *reader, long line, const char *what, Node node);

/* The same of the components of a vector, and of the rows of a matrix. */
struct Vector vector_without_displacements(struct Reader *reader, long line, const char *what, struct Vector vector);
struct Matrix matrix_without_displacements(struct Reader *reader, long line, const char *what, struct Matrix matrix);

/* Adds a term of an element to a sum as it is, and where nothing is displaced to another; returns the latter term. */
Node add_energy(struct Reader *reader, xmlNodePtr node, const char *what, Node term, struct Quantity *displaced,
                struct Quantity *sum);

/* The text of an element as an expression; what names it in messages. */
struct Quantity expression_text_of(struct Reader *reader, xmlNodePtr node, const char *what, unsigned kinds);

/* The same where no event waits for its pieces: abs, min and the like stay whole. */
struct Quantity whole_expression_of(struct Reader *reader, xmlNodePtr node, const char *what, unsigned kinds);

/* The next of a list such as "1 2, 3", behind which the text then is; NULL at the end. */
char *next_listed(const char **text);

/* The unit in an attribute of the element; unknown where missing or after an error. */
struct Dimension unit_attribute(struct Reader *reader, xmlNodePtr node, const char *name);

/* Notes that a node of parameters should not be below 0 at the start values: an error where required, else a warning. */
void expect_not_negative(struct Reader *reader, xmlNodePtr node, const char *what, Node value, bool is_required);

/* Notes that a node of parameters must be above 0 at the start values. */
void expect_size(struct Reader *reader, xmlNodePtr node, const char *what, Node value);

/* Reports an error unless the quantity has the expected unit, such as "kg.m2/s2". */
void require_unit(struct Reader *reader, long line, const char *what, struct Quantity quantity,
                  struct Dimension expected);
