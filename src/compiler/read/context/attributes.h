/* The state of the reader, and attributes of XML elements as strings, numbers, names and expressions. */
#pragma once

#include "model/model.h"
#include "read/context/reader_options.h"
#include "read/expressions/parser.h"
#include "names/piecewise_functions.h"
#include "xml/nodes.h"

/* The passes over the list of elements, in this order. Each uses names that earlier passes defined. */
enum Pass { DECLARATIONS, DEFINITIONS, POSITIONS, EXPRESSIONS, DRAWING };

/* The expression of a <dissipation>, with its line for messages. */
struct Dissipation {
  Node node;
  long line;
};

/* A value that should not be negative at the start values. */
struct Expectation {
  Node node;
  long line;
  const char *what;
  bool is_required, is_size; /* a size: positive and finite */
};

struct Source;
struct Loop;

/* One instance of an element: elements in a <for> or an included file have several. */
struct Occurrence {
  xmlNodePtr node;
  struct Source *source;    /* of the element */
  const struct Loop *loops; /* innermost <for> around it, see definitions.h; NULL for none */
  size_t number;            /* index among the declarations of its kind: coordinates, constraints, contacts, ... */
};

/* Meshes that touch at MOST_CORNERS of more corners; of these the shape whose hull reaches farthest beyond them. */
struct CoarseMeshes {
  size_t count;
  const char *shape;
  long line;
  double residual; /* m */
};

/* The state of the reader, which all readers of elements share. */
struct Reader {
  struct Model *model;
  struct Scope *scope;
  struct Definitions *definitions;
  struct Names *bodies;         /* name -> struct NamedBody */
  struct Names *frames;         /* name -> size_t, an index into the model's frames */
  struct Names *spatial_points; /* name -> struct SpatialPoint, see frames.h */
  struct Names *meshes;         /* path and scale -> struct Mesh, see shape_meshes.h; NULL before the first */
  struct CoarseMeshes coarse_meshes;
  struct Source *source;     /* the current file */
  struct Includes *includes; /* all included files */
  struct Diagnostics *diagnostics;
  const struct ReaderOptions *options;
  bool *definition_used;
  bool has_solver, has_experiment;
  struct Dissipation *dissipations; /* of each <dissipation> */
  size_t dissipation_count;
  struct Expectation *expectations;
  size_t expectation_count;
  Node *undisplaced; /* per symbol: its replacement at zero displacements; NULL before its first use */
  size_t undisplaced_count;
  struct Occurrence *occurrences; /* instances of all elements, with <for> and <include> expanded */
  size_t occurrence_count;
  struct Occurrence *present; /* the instance being read */
};

/* Reports an error on the line of an element. */
void report_at(const struct Reader *reader, xmlNodePtr node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Kinds of symbols that an expression may depend on, as in struct Location. Higher bits hold further conditions. */
#define KIND(kind) (1u << (kind))

enum {
  IN_MASS = KIND(PARAMETER),
  IN_PRESCRIBED_MOTION = KIND(PARAMETER) | KIND(MODE) | KIND(TIME) | KIND(INPUT),
  IN_INERTIA = KIND(PARAMETER) | KIND(MODE) | KIND(COORDINATE) | KIND(TIME) | KIND(DISPLACEMENT),
  WITH_RATES = 1 << 30, /* inputs need time derivatives, as they prescribe a motion */
  IN_POSITION = IN_INERTIA | KIND(INPUT) | KIND(STATE) | WITH_RATES, /* see state_checks.h */
  IN_ENERGY = IN_POSITION | KIND(VELOCITY),
  /* Which derivatives of inputs are needed depends on the velocities in it: see constraint_checks.h. */
  IN_CONSTRAINT = KIND(PARAMETER) | KIND(MODE) | KIND(COORDINATE) | KIND(TIME) | KIND(VELOCITY) | KIND(INPUT),
  IN_POTENTIAL = IN_ENERGY,
  IN_FORCE = IN_INERTIA | KIND(VELOCITY) | KIND(STATE) | KIND(INPUT),
  IN_RATE = (IN_FORCE | KIND(ACCELERATION) | KIND(REACTION)) & ~KIND(DISPLACEMENT),
  IN_OUTPUT = IN_FORCE | KIND(ACCELERATION) | KIND(REACTION) | CONTACT_STATE,
};

/* Returns the context of an expression on the line of an element that may depend on these kinds of symbols. */
struct Location location_of(xmlNodePtr node, const char *what, unsigned kinds);

/* Reads a number from an attribute. Returns false if it is missing, or after reporting an error. */
bool number_attribute(struct Reader *reader, xmlNodePtr node, const char *name, double *value);

/* Like number_attribute(), for a text. name: the attribute for messages. */
bool number_in(struct Reader *reader, xmlNodePtr node, const char *name, const char *text, double *value);

/*
 * Returns the full name in an attribute, with its index evaluated, of something that the element declares. NULL if
 * missing or after an error.
 */
char *name_attribute(struct Reader *reader, xmlNodePtr node, const char *name);

/* Like name_attribute(), for a name that is declared elsewhere, perhaps in an included file. */
char *reference_attribute(struct Reader *reader, xmlNodePtr node, const char *name);

/* Parses the expression in an attribute. Returns true if the attribute is present. kinds: as in struct Location. */
bool expression_attribute(struct Reader *reader, xmlNodePtr node, const char *name, unsigned kinds,
                          struct Quantity *value);

/* Returns the node at zero virtual displacements. Reports a node that has no finite value there. */
Node without_displacements(struct Reader *reader, long line, const char *what, Node node);

/* Do the same for the components of a vector and the elements of a matrix. */
struct Vector vector_without_displacements(struct Reader *reader, long line, const char *what, struct Vector vector);
struct Matrix matrix_without_displacements(struct Reader *reader, long line, const char *what, struct Matrix matrix);

/* Adds a term to the sum over displaced positions, and at zero displacements to the other. Returns the latter. */
Node add_energy(struct Reader *reader, xmlNodePtr node, const char *what, Node term, struct Quantity *displaced,
                struct Quantity *sum);

/* Parses the text of an element as an expression. what: its name in messages. */
struct Quantity expression_text_of(struct Reader *reader, xmlNodePtr node, const char *what, unsigned kinds);

/* Like expression_text_of(), but piecewise functions such as abs and min stay whole, without events. */
struct Quantity whole_expression_of(struct Reader *reader, xmlNodePtr node, const char *what, unsigned kinds);

/* Returns the next item of a list such as "1 2, 3" and advances the text past it; NULL at the end. */
char *next_listed(const char **text);

/* Returns the unit in an attribute; unknown if missing or after an error. */
struct Dimension unit_attribute(struct Reader *reader, xmlNodePtr node, const char *name);

/* Records that a node of parameters should not be negative at the start: an error if required, else a warning. */
void expect_not_negative(struct Reader *reader, xmlNodePtr node, const char *what, Node value, bool is_required);

/* Records that a node must be, or if it is not required should be, positive and finite at the start values. */
void expect_size(struct Reader *reader, xmlNodePtr node, const char *what, Node value, bool is_required);

/* Reports a quantity that does not have the expected unit, such as "kg.m2/s2". */
void require_unit(struct Reader *reader, long line, const char *what, struct Quantity quantity,
                  struct Dimension expected);
