/*
 * The expression graph: a directed acyclic graph in which equal expressions are one node (hash consing, or value
 * numbering; A. P. Ershov: On programming of arithmetic operations, Communications of the ACM 1, 1958). Common
 * subexpressions are shared by construction, and two nodes with the same number are the same expression.
 *
 * Invariants: nodes are never changed or removed. Operands have smaller numbers than their node, so that numeric order
 * is a topological order and every sweep is a loop. Node 0 is the constant 0, node 1 the constant 1. Finding or making
 * a node takes constant time on average: an open-addressing hash table with linear probing, at most half full.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef uint32_t Node;

/* Operations of nodes; functions.h has their properties. */
enum Operation {
  CONSTANT,
  SYMBOL,
  ADD,
  MULTIPLY,
  POWER,
  ATAN2,
  MINIMUM,
  MAXIMUM,
  LESS,  /* 1 if left < right, else 0 */
  GUARD, /* the right operand if the left one is positive, else 0, even if the right one is NaN */
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
  LOGISTIC, /* include/bounded_functions.h has this one and the next five; growth.h makes them */
  SOFTPLUS,
  SECH,
  LOG_COSH,
  CAPPED_EXPONENTIAL,
  CAPPED_SLOPE,
  ABSOLUTE,
  SIGN,
  FLOOR,
  UNIFORM, /* random numbers of a seed and a whole number; see include/random_numbers.h */
  GAUSS,
  OPERATION_COUNT
};

/* Kinds of symbols. Seeds are the directions of directional derivatives. */
enum SymbolKind {
  PARAMETER,
  TIME,
  COORDINATE,
  VELOCITY,
  STATE, /* of first order, with a rate of its own */
  ACCELERATION,
  INPUT,
  DISPLACEMENT, /* virtual displacements, always 0: index 2 i is the i-th, 2 i + 1 its rate */
  REACTION,     /* reaction along a displacement, or that of a prescribed coordinate */
  MODE,         /* changes only at events; indices continue those of parameters */
  DUMMY,        /* variable of an integral or derivative while its expression is read */
  SEED_PARAMETER,
  SEED_TIME,
  SEED_COORDINATE,
  SEED_VELOCITY,
  SEED_STATE,
  SEED_ACCELERATION,
  SEED_INPUT,
  SEED_RESULT, /* weight of a result in a weighted gradient */
  SYMBOL_KIND_COUNT
};

/* A symbol, which is the operand of one SYMBOL node. */
struct Symbol {
  enum SymbolKind kind;
  int index; /* among the symbols of its kind */
  char *name;
  Node node;
};

/* A node's operation and operands. Two nodes never have equal vertices. */
struct Vertex {
  enum Operation operation;
  uint32_t kinds;   /* bit k is set if it depends on a symbol of SymbolKind k */
  Node left, right; /* operands; SYMBOL: left is the index in graph->symbols; unary: right is 0 */
  double value;     /* of CONSTANT */
};

struct Cone;

/* The expression graph, with the invariants above. Symbols are numbered in the order of their creation. */
struct Graph {
  struct Vertex *vertices;
  size_t count;
  Node *buckets; /* hash table of node + 1; 0 if empty */
  size_t bucket_count;
  struct Symbol *symbols;
  size_t symbol_count;
  struct Cone *cone; /* workspace of the sweeps in algebra/; each one overwrites it */
  bool *is_large;    /* of the first large_count nodes: known to be too large to expand, see rational.h */
  size_t large_count;
  bool overflow;   /* NODE_LIMIT was exceeded */
  bool not_finite; /* a constant that is not finite was requested since this was last cleared */
};

/* NODE_LIMIT bounds the memory, WORK_LIMIT the steps of graph_work(), and so the time, that any input file takes. */
enum { NODE_LIMIT = 4000000, WORK_LIMIT = 200000000, ZERO = 0, ONE = 1 };

/* Returns a graph with the constants ZERO and ONE. */
struct Graph *graph_create(void);

/* Returns a copy, which shares no nodes added later. Nodes and symbols of the graph have the same numbers in it. */
struct Graph *graph_copy(const struct Graph *graph);

/* Counts steps of work, each about as long as a visit to a node. The sweeps of algebra/ and the reader call it. */
void graph_work(const struct Graph *graph, size_t steps);

/* Returns the number of steps up to WORK_LIMIT. */
size_t graph_work_left(const struct Graph *graph);

/*
 * Returns a text for the limit that was exceeded, such as "more than 4000000 operations"; NULL if none. Then every new
 * node is ZERO and results have no meaning, so loops over many nodes end.
 */
const char *graph_limit(const struct Graph *graph);

/* Returns the node of a new symbol. name is its name in formulas. */
Node graph_symbol(struct Graph *graph, enum SymbolKind kind, int index, const char *name);

/* Returns the symbol of a SYMBOL node. */
const struct Symbol *graph_symbol_of(const struct Graph *graph, Node node);

/* Returns the node of an operation, without simplification; simplify.h has the algebra. */
Node graph_node(struct Graph *graph, enum Operation operation, Node left, Node right);

Node graph_constant(struct Graph *graph, double value);
bool graph_is_constant(const struct Graph *graph, Node node);
double graph_value(const struct Graph *graph, Node node);

/* Returns the number of operands: 0, 1 or 2. */
int operation_arity(enum Operation operation);

/* Returns the name of an operation in formulas and messages. */
const char *operation_name(enum Operation operation);

/* Returns the value of an operation on numbers. */
double operation_evaluate(enum Operation operation, double left, double right);

/* True if the node depends on a symbol of this kind. */
bool graph_depends_on(const struct Graph *graph, Node node, enum SymbolKind kind);

/* True if the node depends only on parameters and modes, and so is constant between events. */
bool graph_is_constant_in_time(const struct Graph *graph, Node node);

/* Marks the targets and all nodes below them; clears other flags. flags has one element for each node. */
void graph_mark(const struct Graph *graph, const Node *targets, size_t count, bool *flags);

/* Returns the values of all nodes. symbol_values has the order of graph->symbols. */
double *graph_evaluate(const struct Graph *graph, const double *symbol_values);

/* Returns the values of the first count nodes. */
double *graph_evaluate_first(const struct Graph *graph, const double *symbol_values, size_t count);

/* Evaluates the given nodes, operands first; values has one element for each node of the graph. */
void graph_evaluate_part(const struct Graph *graph, const Node *nodes, size_t count, const double *symbol_values,
                         double *values);
