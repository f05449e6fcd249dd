/*
 * The expression graph. Every expression is a node; equal expressions are one node (hash-consing), so common
 * sub-expressions are shared by construction. A node's operands always have smaller numbers than the node:
 * numeric order is a topological order, and every sweep is a plain loop.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef uint32_t Node;

/* What a node does; functions.h knows what each of them is. */
enum Operation {
  CONSTANT,
  SYMBOL,
  ADD,
  MULTIPLY,
  POWER,
  ATAN2,
  MINIMUM,
  MAXIMUM,
  LESS, /* 1 where the left operand is less than the right one, else 0 */
  GATE, /* the right operand where the left one is positive, else 0, whatever the right one is */
  SINE,
  COSINE,
  TANGENT,
  ARCSINE,
  ARCCOSINE,
  ARCTANGENT,
  SINH,
  COSH,
  TANH,
  ARSINH,
  ARCOSH,
  ARTANH,
  EXPONENTIAL,
  LOGARITHM,
  ABSOLUTE,
  SIGN,
  FLOOR,
  UNIFORM, /* random numbers of a seed and a whole number: include/random_numbers.h */
  GAUSS,
  OPERATION_COUNT
};

/* What a symbol stands for. The seeds are the directions of directional derivatives. */
enum SymbolKind {
  PARAMETER,
  TIME,
  COORDINATE,
  VELOCITY,
  STATE, /* behind the velocities, with a rate of its own */
  ACCELERATION,
  INPUT,
  DISPLACEMENT, /* a virtual one, always 0: index 2 i of the i-th, 2 i + 1 of its rate */
  REACTION,     /* the force along a displacement, or of the drive of a coordinate */
  MODE,         /* changes at events alone; its index counts on behind the parameters */
  DUMMY,        /* the variable of an integral or a derivative while its expression is read */
  SEED_PARAMETER,
  SEED_TIME,
  SEED_COORDINATE,
  SEED_VELOCITY,
  SEED_STATE,
  SEED_ACCELERATION,
  SEED_INPUT,
  SEED_RESULT, /* by what a result counts in a weighted gradient */
  SYMBOL_KIND_COUNT
};

struct Symbol {
  enum SymbolKind kind;
  int index; /* among the symbols of its kind */
  char *name;
  Node node;
};

struct Vertex {
  enum Operation operation;
  uint32_t kinds;   /* bit k: depends on a symbol of SymbolKind k */
  Node left, right; /* operands; SYMBOL: left is the symbol's number; unary: right is 0 */
  double value;     /* CONSTANT only */
};

struct Cone;

struct Graph {
  struct Vertex *vertices;
  size_t count;
  Node *buckets; /* hash table of node + 1, 0 where empty */
  size_t bucket_count;
  struct Symbol *symbols;
  size_t symbol_count;
  struct Cone *cone; /* workspace of the sweeps in algebra/, each of which collects anew */
  bool *is_large;    /* of the first large_count nodes: known to be too large for expanding, see rational.h */
  size_t large_count;
  bool overflow;   /* more than NODE_LIMIT nodes were asked for */
  bool not_finite; /* a constant that is no finite number was asked for, since this was last set to false */
};

enum { NODE_LIMIT = 4000000, WORK_LIMIT = 100000000, ZERO = 0, ONE = 1 };

struct Graph *graph_create(void);

/*
 * Counts steps of work, each about as long as a visit to a node: the sweeps of algebra/ count themselves, and so does
 * reading. Both limits together bound the time that any file takes.
 */
void graph_work(const struct Graph *graph, size_t steps);

/*
 * Which limit the graph has gone beyond, such as "more than 4000000 operations"; NULL where none. Then no new node is made,
 * ZERO stands for it, and results are not meaningful: loops over many nodes or elements end.
 */
const char *graph_limit(const struct Graph *graph);

/* The node of a new symbol; kind and index say what it stands for, name how it is printed. */
Node graph_symbol(struct Graph *graph, enum SymbolKind kind, int index, const char *name);

/* The symbol that a SYMBOL node stands for. */
const struct Symbol *graph_symbol_of(const struct Graph *graph, Node node);

/* The node with these operands as they are, without simplification; see simplify.h for the algebra. */
Node graph_node(struct Graph *graph, enum Operation operation, Node left, Node right);

Node graph_constant(struct Graph *graph, double value);
bool graph_is_constant(const struct Graph *graph, Node node);
double graph_value(const struct Graph *graph, Node node);

/* How many operands an operation has: 0, 1 or 2. */
int operation_arity(enum Operation operation);

/* Its name in formulas and messages. */
const char *operation_name(enum Operation operation);

/* The value of an operation on numbers. */
double operation_evaluate(enum Operation operation, double left, double right);

/* Whether the node depends on a symbol of this kind. */
bool graph_depends_on(const struct Graph *graph, Node node, enum SymbolKind kind);

/* Whether the node is made of numbers, parameters and modes alone, so that it does not change between events. */
bool graph_is_constant_in_time(const struct Graph *graph, Node node);

/* Marks every node that the targets need, themselves included; flags has one element a node, zeroed here. */
void graph_mark(const struct Graph *graph, const Node *targets, size_t count, bool *flags);

/* Evaluates all nodes; symbol_values in the order of graph->symbols; one value for each. */
double *graph_evaluate(const struct Graph *graph, const double *symbol_values);

/* Evaluates the first nodes, which need none behind them. */
double *graph_evaluate_first(const struct Graph *graph, const double *symbol_values, size_t count);

/* The same of these nodes alone, operands before what they are operands of; values has a place for each node of the graph. */
void graph_evaluate_part(const struct Graph *graph, const Node *nodes, size_t count, const double *symbol_values,
                         double *values);
