#include "read/expressions/constructs.h"

#include <ctype.h>
#include <string.h>

#include "algebra/simplify.h"
#include "read/expressions/parser.h"
#include "read/expressions/quantities.h"
#include "names/piecewise_functions.h"

enum Comparison { NO_COMPARISON, MORE, MORE_OR_EQUAL, LESS_THAN_OTHER, LESS_OR_EQUAL };

static bool accept_word(struct Parser *parser, const char *word) {
  skip_space(parser);
  size_t length = strlen(word);
  char behind = parser->next[strncmp(parser->next, word, length) == 0 ? length : 0];
  if (strncmp(parser->next, word, length) != 0 || isalnum((unsigned char)behind) || behind == '_') return false;
  parser->next += length;
  return true;
}

static bool is_of_word(char letter) {
  return isalnum((unsigned char)letter) || letter == '_';
}

/* True if the text begins with the word and, or, or not. before: the preceding character. */
static bool is_connective(char before, const char *text) {
  static const char *const words[] = {"and", "or", "not"};
  for (size_t i = 0; i < sizeof words / sizeof *words && !is_of_word(before) && before != '.'; i++) {
    size_t length = strlen(words[i]);
    if (strncmp(text, words[i], length) == 0 && !is_of_word(text[length])) return true;
  }
  return false;
}

bool is_condition(const char *text) {
  char before = ' ';
  for (; *text != '\0'; before = *text++)
    if (strchr("<>=", *text) != NULL || is_connective(before, text)) return true;
  return false;
}

static enum Comparison parse_comparison(struct Parser *parser) {
  bool is_more = accept_character(parser, '>'), is_less = !is_more && accept_character(parser, '<');
  bool or_equal = (is_more || is_less) && *parser->next == '=';
  if (or_equal) parser->next++;
  if (is_more) return or_equal ? MORE_OR_EQUAL : MORE;
  if (is_less) return or_equal ? LESS_OR_EQUAL : LESS_THAN_OTHER;
  return NO_COMPARISON;
}

/*
 * Reports a comparison by =: along a motion two numbers are equal at an instant only, which no test between steps
 * finds.
 */
static void reject_equality(struct Parser *parser) {
  skip_space(parser);
  bool is_unequal = strncmp(parser->next, "!=", 2) == 0;
  if (is_unequal || *parser->next == '=')
    FAIL(parser,
         "%s: found '%s'; write >= for what comes to a value, as in time >= 2, and n > 1.5 and n < 2.5 for a whole "
         "number n that is 2",
         parser->location.what,
         is_unequal               ? "!="
         : parser->next[1] == '=' ? "=="
                                  : "=");
}

static Node is_positive(struct Graph *graph, Node condition) {
  return function(graph, GUARD, condition, ONE);
}

static Node negation(struct Graph *graph, Node condition) {
  return subtract(graph, ONE, is_positive(graph, condition));
}

static Node both(struct Graph *graph, Node first, Node second) {
  return function(graph, GUARD, first, is_positive(graph, second));
}

/* Parses a comparison of two sums with equal units, or a single mode or Boolean parameter. */
static Node parse_relation(struct Parser *parser) {
  struct Graph *graph = parser->graph;
  const char *begin = parser->next + strspn(parser->next, " \t\r\n");
  struct Quantity left = parse_sum(parser);
  if (!parser->failed) reject_equality(parser);
  enum Comparison comparison = parser->failed ? NO_COMPARISON : parse_comparison(parser);
  if (parser->failed) return ZERO;
  if (comparison == NO_COMPARISON) {
    if (graph_is_constant_in_time(graph, left.node)) return left.node;
    int length = (int)(parser->next - begin);
    while (length > 0 && strchr(" \t\r\n", begin[length - 1]) != NULL) length--;
    FAIL(parser, "%s: the condition '%.*s' is not a comparison; expected one such as %.*s > 0", parser->location.what,
         length, begin, length, begin);
    return ZERO;
  }
  struct Quantity right = parse_sum(parser);
  if (parser->failed) return ZERO;
  bool is_more = comparison == MORE || comparison == MORE_OR_EQUAL;
  struct Quantity difference = quantity_subtract(parser, is_more ? left : right, is_more ? right : left);
  if (parser->failed) return ZERO;
  Node sign = branch_of(parser->scope, difference.node, "a condition", current_line(parser));
  return comparison == MORE || comparison == LESS_THAN_OTHER ? sign : negation(graph, negate(graph, sign));
}

/* True if the parentheses at the reading position enclose a condition rather than an operand of a sum or comparison. */
static bool is_group(const struct Parser *parser) {
  const char *next = parser->next;
  int depth = 0;
  bool compares = false;
  do {
    depth += (*next == '(') - (*next == ')');
    compares |= *next == '<' || *next == '>' || (*next != '(' && is_connective(next[-1], next));
    next++;
  } while (*next != '\0' && depth > 0);
  while (isspace((unsigned char)*next)) next++;
  return compares && strchr("+-*/^<>", *next == '\0' ? ' ' : *next) == NULL;
}

static Node parse_group(struct Parser *parser) {
  if (*parser->next != '(' || !is_group(parser)) return parse_relation(parser);
  parser->next++;
  if (++parser->nesting > 100)
    FAIL(parser, "%s: conditions are nested more than 100 deep; expected fewer, or a <define> for a part",
         parser->location.what);
  Node condition = parser->failed ? ZERO : parse_condition(parser);
  parser->nesting--;
  expect_character(parser, ')', "to close a condition");
  return condition;
}

/* Parses { not } and a condition. Beyond two, only the parity of negations counts; two map the condition to 1 or 0. */
static Node parse_factor(struct Parser *parser) {
  long negations = 0;
  while (accept_word(parser, "not")) negations++;
  skip_space(parser);
  Node condition = parse_group(parser);
  for (long i = negations > 2 ? 2 - negations % 2 : negations; i > 0; i--)
    condition = negation(parser->graph, condition);
  return condition;
}

static Node parse_conjunction(struct Parser *parser) {
  Node condition = parse_factor(parser);
  while (!parser->failed && accept_word(parser, "and"))
    condition = both(parser->graph, condition, parse_factor(parser));
  return condition;
}

Node parse_condition(struct Parser *parser) {
  struct Graph *graph = parser->graph;
  Node condition = parse_conjunction(parser);
  while (!parser->failed && accept_word(parser, "or")) {
    Node neither = negation(graph, condition);
    condition = negation(graph, both(graph, neither, negation(graph, parse_conjunction(parser))));
  }
  return condition;
}

struct Quantity parse_choice(struct Parser *parser) {
  static const struct Quantity nothing = {.node = ZERO};
  Node condition = parse_condition(parser);
  expect_character(parser, ',', "after the condition of if(condition, expression, expression)");
  /* Drops the requirements of domains: each expression needs a value only while it is chosen. */
  size_t requirements = parser->scope->requirements.count;
  struct Quantity positive = parser->failed ? nothing : parse_sum(parser);
  expect_character(parser, ',', "between the two expressions of if(condition, expression, expression)");
  struct Quantity other = parser->failed ? nothing : parse_sum(parser);
  parser->scope->requirements.count = requirements;
  expect_character(parser, ')', "at the end of if(condition, expression, expression)");
  if (parser->failed) return nothing;
  struct Quantity result = quantity_add(parser, positive, other); /* checks that their units agree */
  result.node = choose_node(parser->graph, condition, positive.node, other.node);
  return result;
}
