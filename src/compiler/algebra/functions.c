#include "algebra/functions.h"

#include <math.h>

#include "algebra/simplify.h"
#include "bounded_functions.h"
#include "random_numbers.h"

/* --- Values on numbers, if C's math library has no function or a less exact one --- */

static double sum_of(double left, double right) {
  return left + right;
}

static double product_of_two(double left, double right) {
  return left * right;
}

static double is_less(double left, double right) {
  return left < right ? 1.0 : 0.0;
}

static double guard_of(double guard_condition, double x) {
  return guard_condition > 0.0 ? x : 0.0;
}

static double sign_of(double x) {
  return (double)((x > 0.0) - (x < 0.0));
}

/* Returns sin(angle + quarter_turns pi/2). Multiples of pi/2 give exact values, for linearization there. */
static double exact_sine(double angle, double quarter_turns) {
  double turns = quarter_turns + nearbyint(angle / (M_PI / 2));
  if (fabs(turns) < 1e6 && angle == (turns - quarter_turns) * (M_PI / 2)) {
    static const double values[4] = {0.0, 1.0, 0.0, -1.0};
    return values[(long)turns & 3];
  }
  return quarter_turns > 0 ? cos(angle) : sin(angle);
}

static double sine(double angle) {
  return exact_sine(angle, 0.0);
}

static double cosine(double angle) {
  return exact_sine(angle, 1.0);
}

static double tangent(double angle) {
  return sine(angle) / cosine(angle);
}

/* --- Auxiliary expressions of a node y = f(x) --- */

static Node operand(struct Graph *graph, Node node) {
  return graph->vertices[node].left;
}

static Node itself(struct Graph *graph, Node node) {
  (void)graph;
  return node;
}

static Node sine_of_operand(struct Graph *graph, Node node) {
  return function(graph, SINE, operand(graph, node), ZERO);
}

static Node cosine_of_operand(struct Graph *graph, Node node) {
  return function(graph, COSINE, operand(graph, node), ZERO);
}

static Node sinh_of_operand(struct Graph *graph, Node node) {
  return function(graph, SINH, operand(graph, node), ZERO);
}

static Node cosh_of_operand(struct Graph *graph, Node node) {
  return function(graph, COSH, operand(graph, node), ZERO);
}

static Node tanh_of_operand(struct Graph *graph, Node node) {
  return function(graph, TANH, operand(graph, node), ZERO);
}

static Node logistic_of_operand(struct Graph *graph, Node node) {
  return function(graph, LOGISTIC, operand(graph, node), ZERO);
}

static Node slope_of_capped(struct Graph *graph, Node node) {
  return function(graph, CAPPED_SLOPE, operand(graph, node), ZERO);
}

static Node times_tanh_of_operand(struct Graph *graph, Node node) {
  return multiply(graph, node, tanh_of_operand(graph, node));
}

static Node times_one_minus_itself(struct Graph *graph, Node node) {
  return multiply(graph, node, subtract(graph, ONE, node));
}

/* Returns constant + factor node^2. */
static Node with_square(struct Graph *graph, double constant, double factor, Node node) {
  Node square = scale(graph, factor, power_number(graph, node, 2.0));
  return add(graph, graph_constant(graph, constant), square);
}

static Node one_plus_own_square(struct Graph *graph, Node node) {
  return with_square(graph, 1.0, 1.0, node);
}

static Node one_minus_own_square(struct Graph *graph, Node node) {
  return with_square(graph, 1.0, -1.0, node);
}

static Node one_plus_square(struct Graph *graph, Node node) {
  return with_square(graph, 1.0, 1.0, operand(graph, node));
}

static Node one_minus_square(struct Graph *graph, Node node) {
  return with_square(graph, 1.0, -1.0, operand(graph, node));
}

static Node root_of_one_plus_square(struct Graph *graph, Node node) {
  return power_number(graph, one_plus_square(graph, node), 0.5);
}

static Node root_of_one_minus_square(struct Graph *graph, Node node) {
  return power_number(graph, one_minus_square(graph, node), 0.5);
}

static Node root_of_square_minus_one(struct Graph *graph, Node node) {
  return power_number(graph, with_square(graph, -1.0, 1.0, operand(graph, node)), 0.5);
}

static Node sum_of_squares(struct Graph *graph, Node node) {
  Node left = graph->vertices[node].left, right = graph->vertices[node].right;
  Node other = power_number(graph, right, 2.0);
  return add(graph, power_number(graph, left, 2.0), other);
}

static Node difference(struct Graph *graph, Node node) {
  return subtract(graph, graph->vertices[node].left, graph->vertices[node].right);
}

/*
 * Returns the auxiliary of a power. Whole powers come from smaller ones, so that a base of 0 is allowed. Negative
 * ones are reciprocals; exponents that vary in time use exp and log.
 */
static Node auxiliary_of_power(struct Graph *graph, Node node) {
  Node base = graph->vertices[node].left, exponent = graph->vertices[node].right;
  if (!graph_is_constant_in_time(graph, exponent))
    return multiply(graph, exponent, function(graph, LOGARITHM, base, ZERO));
  double n = graph_is_constant(graph, exponent) ? graph_value(graph, exponent) : NAN;
  if (n == -0.5 || (n == floor(n) && n < -1.0)) return graph_node(graph, POWER, base, graph_constant(graph, -n));
  if (n != floor(n) || n < 3.0) return ZERO;
  double lower = fmod(n, 2.0) == 0.0 ? n / 2.0 : n - 1.0;
  return graph_node(graph, POWER, base, graph_constant(graph, lower));
}

/* --- Partial derivatives of operations whose recurrence does not give them; by_right stays ZERO for one operand --- */

static void partials_of_sum(struct Graph *graph, Node node, Node *by_left, Node *by_right) {
  (void)graph;
  (void)node;
  *by_left = *by_right = ONE;
}

static void partials_of_product(struct Graph *graph, Node node, Node *by_left, Node *by_right) {
  *by_left = graph->vertices[node].right;
  *by_right = graph->vertices[node].left;
}

static void partials_of_power(struct Graph *graph, Node node, Node *by_left, Node *by_right) {
  Node base = graph->vertices[node].left, exponent = graph->vertices[node].right;
  *by_left = multiply(graph, exponent, power(graph, base, subtract(graph, exponent, ONE)));
  if (!graph_is_constant(graph, exponent)) *by_right = multiply(graph, function(graph, LOGARITHM, base, ZERO), node);
}

static void partials_of_angle(struct Graph *graph, Node node, Node *by_left, Node *by_right) {
  Node y = graph->vertices[node].left, x = graph->vertices[node].right, square = sum_of_squares(graph, node);
  *by_left = divide(graph, x, square);
  *by_right = negate(graph, divide(graph, y, square));
}

static void partials_of_minimum(struct Graph *graph, Node node, Node *by_left, Node *by_right) {
  *by_right = function(graph, LESS, graph->vertices[node].right, graph->vertices[node].left);
  *by_left = subtract(graph, ONE, *by_right);
}

static void partials_of_maximum(struct Graph *graph, Node node, Node *by_left, Node *by_right) {
  *by_right = function(graph, LESS, graph->vertices[node].left, graph->vertices[node].right);
  *by_left = subtract(graph, ONE, *by_right);
}

static void partials_of_guard(struct Graph *graph, Node node, Node *by_left, Node *by_right) {
  *by_left = ZERO;
  *by_right = function(graph, GUARD, operand(graph, node), ONE);
}

static void partials_of_absolute(struct Graph *graph, Node node, Node *by_left, Node *by_right) {
  (void)by_right;
  *by_left = function(graph, SIGN, operand(graph, node), ZERO);
}

/* --- The table --- */

const struct Function functions[OPERATION_COUNT] = {
    [CONSTANT] = {.name = "constant", .is_internal = true},
    [SYMBOL] = {.name = "symbol", .is_internal = true},
    [ADD] = {.name = "add", .is_internal = true, .of_two = sum_of, .partial_derivatives = partials_of_sum},
    [MULTIPLY] = {.name = "multiply",
                  .is_internal = true,
                  .of_two = product_of_two,
                  .partial_derivatives = partials_of_product},
    [POWER] = {.name = "pow",
               .of_two = pow,
               .domain = {CLOSED, 0.0, INFINITY},
               .domain_text = "that is not negative",
               .auxiliary = auxiliary_of_power,
               .partial_derivatives = partials_of_power},
    [ATAN2] = {.name = "atan2",
               .of_two = atan2,
               .units = UNIT_LOST,
               .recurrence = ANGLE,
               .auxiliary = sum_of_squares,
               .partial_derivatives = partials_of_angle,
               .auxiliary_limit = "positive"}, /* both operands have a limit too: series_limit_angle() */
    [MINIMUM] = {.name = "min",
                 .c_name = "fmin",
                 .of_two = fmin,
                 .units = UNIT_KEPT,
                 .recurrence = CHOICE,
                 .auxiliary = difference,
                 .partial_derivatives = partials_of_minimum,
                 .has_pieces = true,
                 .auxiliary_limit = "sign"},
    [MAXIMUM] = {.name = "max",
                 .c_name = "fmax",
                 .of_two = fmax,
                 .units = UNIT_KEPT,
                 .recurrence = CHOICE,
                 .auxiliary = difference,
                 .partial_derivatives = partials_of_maximum,
                 .has_pieces = true,
                 .auxiliary_limit = "sign"},
    [LESS] = {.name = "less",
              .is_internal = true,
              .of_two = is_less,
              .is_never_negative = true,
              .units = UNIT_LOST,
              .recurrence = PIECEWISE_CONSTANT,
              .auxiliary = difference,
              .has_pieces = true,
              .auxiliary_limit = "sign"},
    [GUARD] = {.name = "gate",
               .is_internal = true,
               .of_two = guard_of,
               .units = UNIT_KEPT,
               .recurrence = GUARDED,
               .auxiliary = operand,
               .partial_derivatives = partials_of_guard},
    [SINE] = {.name = "sin", .of_one = sine, .parity = ODD, .recurrence = INTEGRAL, .auxiliary = cosine_of_operand},
    [COSINE] = {.name = "cos",
                .of_one = cosine,
                .parity = EVEN,
                .recurrence = INTEGRAL,
                .is_reversed = true,
                .auxiliary = sine_of_operand},
    [TANGENT] = {.name = "tan",
                 .of_one = tangent,
                 .parity = ODD,
                 .domain_text = "between its poles",
                 .recurrence = INTEGRAL,
                 .auxiliary = one_plus_own_square,
                 .operand_limit = "tangent"},
    [ARCSINE] = {.name = "asin",
                 .of_one = asin,
                 .parity = ODD,
                 .domain = {CLOSED, -1.0, 1.0},
                 .domain_text = "from -1 to 1",
                 .recurrence = RATIO,
                 .auxiliary = root_of_one_minus_square,
                 .folded = {SINE, COSINE},
                 .fold_name = "asin of a sine"},
    [ARCCOSINE] = {.name = "acos",
                   .of_one = acos,
                   .is_never_negative = true,
                   .domain = {CLOSED, -1.0, 1.0},
                   .domain_text = "from -1 to 1",
                   .recurrence = RATIO,
                   .is_reversed = true,
                   .auxiliary = root_of_one_minus_square,
                   .folded = {SINE, COSINE},
                   .fold_name = "acos of a cosine"},
    [ARCTANGENT] = {.name = "atan",
                    .of_one = atan,
                    .parity = ODD,
                    .recurrence = RATIO,
                    .auxiliary = one_plus_square,
                    .folded = {TANGENT},
                    .fold_name = "atan of a tangent",
                    .auxiliary_limit = "positive"},
    [SINH] = {.name = "sinh",
              .of_one = sinh,
              .parity = ODD,
              .recurrence = INTEGRAL,
              .auxiliary = cosh_of_operand,
              .operand_limit = "hyperbolic"},
    [COSH] = {.name = "cosh",
              .of_one = cosh,
              .parity = EVEN,
              .is_never_negative = true,
              .recurrence = INTEGRAL,
              .auxiliary = sinh_of_operand,
              .operand_limit = "hyperbolic"},
    [TANH] = {.name = "tanh",
              .of_one = tanh,
              .parity = ODD,
              .recurrence = INTEGRAL,
              .auxiliary = one_minus_own_square,
              .operand_limit = "tanh"},
    [ARSINH] = {.name = "asinh",
                .of_one = asinh,
                .parity = ODD,
                .recurrence = RATIO,
                .auxiliary = root_of_one_plus_square,
                .auxiliary_limit = "positive"},
    [ARCOSH] = {.name = "acosh",
                .of_one = acosh,
                .is_never_negative = true,
                .domain = {CLOSED, 1.0, INFINITY},
                .domain_text = "of 1 or more",
                .recurrence = RATIO,
                .auxiliary = root_of_square_minus_one,
                .folded = {COSH},
                .fold_name = "acosh of a cosh"},
    [ARTANH] = {.name = "atanh",
                .of_one = atanh,
                .parity = ODD,
                .domain = {OPEN, -1.0, 1.0},
                .domain_text = "between -1 and 1",
                .recurrence = RATIO,
                .auxiliary = one_minus_square,
                .auxiliary_limit = "positive"},
    [EXPONENTIAL] = {.name = "exp",
                     .of_one = exp,
                     .is_never_negative = true,
                     .recurrence = INTEGRAL,
                     .auxiliary = itself,
                     .operand_limit = "exponential"},
    [LOGARITHM] = {.name = "log",
                   .of_one = log,
                   .domain = {OPEN, 0.0, INFINITY},
                   .domain_text = "that is positive",
                   .recurrence = RATIO,
                   .auxiliary = operand,
                   .auxiliary_limit = "positive"},
    [LOGISTIC] = {.name = "1/(1 + exp)",
                  .is_internal = true,
                  .c_name = "logistic",
                  .of_one = logistic,
                  .is_never_negative = true,
                  .recurrence = INTEGRAL,
                  .auxiliary = times_one_minus_itself,
                  .operand_limit = "bounded"},
    [SOFTPLUS] = {.name = "log(1 + exp)",
                  .is_internal = true,
                  .c_name = "softplus",
                  .of_one = softplus,
                  .is_never_negative = true,
                  .recurrence = INTEGRAL,
                  .auxiliary = logistic_of_operand,
                  .operand_limit = "bounded"},
    [SECH] = {.name = "1/cosh",
              .is_internal = true,
              .c_name = "sech",
              .of_one = sech,
              .parity = EVEN,
              .is_never_negative = true,
              .recurrence = INTEGRAL,
              .is_reversed = true,
              .auxiliary = times_tanh_of_operand,
              .operand_limit = "bounded"},
    [LOG_COSH] = {.name = "log(cosh)",
                  .is_internal = true,
                  .c_name = "log_cosh",
                  .of_one = log_cosh,
                  .parity = EVEN,
                  .is_never_negative = true,
                  .recurrence = INTEGRAL,
                  .auxiliary = tanh_of_operand,
                  .operand_limit = "bounded"},
    [CAPPED_EXPONENTIAL] = {.name = "exp(min)",
                            .is_internal = true,
                            .c_name = "capped_exp",
                            .of_one = capped_exp,
                            .is_never_negative = true,
                            .recurrence = INTEGRAL,
                            .auxiliary = slope_of_capped,
                            .operand_limit = "bounded"},
    [CAPPED_SLOPE] = {.name = "exp(min)'",
                      .is_internal = true,
                      .c_name = "capped_exp_slope",
                      .of_one = capped_exp_slope,
                      .is_never_negative = true,
                      .recurrence = INTEGRAL,
                      .auxiliary = itself,
                      .operand_limit = "bounded"},
    [ABSOLUTE] = {.name = "abs",
                  .c_name = "fabs",
                  .of_one = fabs,
                  .parity = EVEN,
                  .is_never_negative = true,
                  .units = UNIT_KEPT,
                  .recurrence = REFLECTION,
                  .auxiliary = operand,
                  .partial_derivatives = partials_of_absolute,
                  .has_pieces = true,
                  .auxiliary_limit = "sign"},
    [SIGN] = {.name = "sign",
              .of_one = sign_of,
              .parity = ODD,
              .units = UNIT_LOST,
              .recurrence = PIECEWISE_CONSTANT,
              .auxiliary = operand,
              .has_pieces = true,
              .auxiliary_limit = "sign"},
    [FLOOR] =
        {.name = "floor", .is_internal = true, .of_one = floor, .recurrence = PIECEWISE_CONSTANT, .auxiliary = operand},
    [UNIFORM] = {.name = "uniform",
                 .is_internal = true,
                 .c_name = "random_uniform",
                 .of_two = random_uniform,
                 .is_never_negative = true,
                 .recurrence = PIECEWISE_CONSTANT,
                 .auxiliary = operand},
    [GAUSS] = {.name = "gauss",
               .is_internal = true,
               .c_name = "random_gauss",
               .of_two = random_gauss,
               .recurrence = PIECEWISE_CONSTANT,
               .auxiliary = operand},
};
