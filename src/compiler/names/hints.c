#include "names/hints.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

/* A construct of another language, and the end of the message about it. */
struct Hint {
  const char *written, *hint;
};

static const struct Hint of_text[] = {
    {"**", "; write ^ for a power"},
    {"*", "; write one * for a product and ^ for a power"},
    {"%", "; write mod(a, b) for a remainder, and 0.01 for a percent"},
    {"==", "; write if(x >= 2, ..., ...) for values that depend on a condition"},
    {"!", "; write if(x > 0, ..., ...), and conditions with and, or, not"},
    {"?", "; write if(x > 0, ..., ...), and conditions with and, or, not"},
    {"&&", "; write and"},
    {"||", "; write or"},
    {"&", "; write if(x > 0, ..., ...), and conditions with and, or, not"},
    {"<", "; write if(x > 0, ..., ...) for values that depend on a condition"},
    {">", "; write if(x > 0, ..., ...) for values that depend on a condition"},
    {"=", "; write the value alone, without a name and ="},
    {"[", "; write round parentheses, and [...] only for the index of a name"},
    {"{", "; write round parentheses"},
    {"|", "; write abs(...) for a magnitude"},
    {"'", "; write der(...) for a time derivative"},
    {";", "; leave out the ;"},
    {"\xc2\xb7", "; write * for a product"},
    {"\xc3\x97", "; write * for a product"},
    {"\xe2\x88\x92", "; write - for a minus sign"},
    {"\xe2\x80\x93", "; write - for a minus sign"},
    {"\xe2\x80\x94", "; write - for a minus sign"},
    {"\xc2\xb2", "; write ^2 for a square"},
    {"\xc2\xb3", "; write ^3 for a cube"},
    {"\xc2\xb0", "; write radians, as in 30*pi/180"},
    {"\xc2\xa0", "; write a plain blank, not a no-break space"},
    {"\xe2\x80\x8b", "; an invisible character stands here: remove it"},
};

static const struct Hint of_functions[] = {
    {"interp", "; write <table name=\"f\"> and f(x)"},
    {"interpolate", "; write <table name=\"f\"> and f(x)"},
    {"lookup", "; write <table name=\"f\"> and f(x)"},
    {"table", "; write <table name=\"f\"> and f(x)"},
    {"ln", "; write log for the natural logarithm"},
    {"log10", "; write log(x)/log(10)"},
    {"log2", "; write log(x)/log(2)"},
    {"cosine", "; did you mean 'cos'?"},
    {"tangent", "; did you mean 'tan'?"},
    {"arcsin", "; write asin"},
    {"arccos", "; write acos"},
    {"arctan", "; write atan"},
    {"arctan2", "; write atan2"},
    {"fabs", "; write abs"},
    {"sgn", "; write sign"},
    {"int", "; write sign(x)*floor(abs(x)) for the whole part, integral(s, a, b, expression) for an integral over s"},
    {"integrate", "; write integral(s, a, b, expression) for an integral over s, <state name=\"z\" rate=\"...\"/> for "
                  "one over time"},
    {"ddt", "; write der for a time derivative"},
    {"dot", "; write der for a time derivative"},
    {"ddot", "; write der(v) of the velocity for an acceleration"},
    {"sin2", "; write sin(...)^2"},
    {"cos2", "; write cos(...)^2"},
    {"rem", "; write mod(a, b)"},
    {"fmod", "; write mod(a, b)"},
    {"trunc", "; write sign(x)*floor(abs(x))"},
    {"rint", "; write round(x)"},
    {"step", "; write if(x > 0, 1, 0)"},
    {"heaviside", "; write if(x > 0, 1, 0)"},
    {"saturate", "; write min(high, max(low, x))"},
    {"sat", "; write min(high, max(low, x))"},
    {"clip", "; write min(high, max(low, x))"},
    {"clamp", "; write min(high, max(low, x))"},
    {"limit", "; write min(high, max(low, x))"},
    {"deadzone", "; write x - min(d, max(-d, x))"},
    {"hypot", "; write sqrt(x^2 + y^2)"},
    {"delay", "; write <state name=\"z\" rate=\"(u - z)/T\"/> for a lag of T, or a <mode> that an <event> sets"},
    {"rand", "; write uniform(seed, k) with whole numbers k, such as floor(time/0.01)"},
    {"random", "; write uniform(seed, k) with whole numbers k, such as floor(time/0.01)"},
    {"randn", "; write gauss(seed, k) with whole numbers k, such as floor(time/0.01)"},
    {"noise", "; write gauss(seed, k) with whole numbers k, such as floor(time/0.01)"},
    {"cbrt", "; write sign(x)*abs(x)^(1/3)"},
    {"fix", "; write sign(x)*floor(abs(x))"},
    {"sqr", "; write x^2"},
    {"sec", "; write 1/cos(x)"},
    {"csc", "; write 1/sin(x)"},
    {"cot", "; write 1/tan(x)"},
    {"erf", "; write 2/sqrt(pi)*integral(s, 0, x, exp(-s^2))"},
    {"deg2rad", "; write x*pi/180"},
    {"radians", "; write x*pi/180"},
    {"rad2deg", "; write x*180/pi"},
    {"degrees", "; write x*180/pi"},
    {"derivative", "; write der for a time derivative, diff(e, s) for one by a name"},
    {"pulse", "; write if(w > mod(time, T), 1, 0) for pulses of the length w"},
    {"piecewise", "; write if(c, a, b), or <table name=\"f\"> and f(x)"},
    {"and", "; write and between two conditions, as in x > 0 and y > 0"},
    {"or", "; write or between two conditions, as in x > 0 or y > 0"},
    {"pre", "; write the name alone, whose value in <set> is that before the event"},
    {"previous", "; write the name alone, whose value in <set> is that before the event"},
    {"edge", "; write the condition alone in when=\"...\", which is an event when it comes to hold"},
    {"sample", "; write <sample every=\"...\"> in place of the <event>"},
    {"initial", "; write start=\"...\" of what has another value at the start"},
};

static const struct Hint of_names[] = {
    {"t", "; write time for the time"},
    {"e", "; write exp(x) for a power of e"},
    {"nan", "; a value must be a finite number"},
    {"NaN", "; a value must be a finite number"},
    {"inf", "; a value must be a finite number; leave out a limit that is infinite"},
    {"INF", "; a value must be a finite number; leave out a limit that is infinite"},
    {"infinity", "; a value must be a finite number; leave out a limit that is infinite"},
    {"Infinity", "; a value must be a finite number; leave out a limit that is infinite"},
    {"true", "; write 1 or 0, or type=\"Boolean\" for a parameter that is true or false"},
    {"false", "; write 1 or 0, or type=\"Boolean\" for a parameter that is true or false"},
};

static const struct Hint of_elements[] = {
    {"lagrangian", "write the Lagrangian as <kinetic> and <potential>"},
    {"Lagrangian", "write the Lagrangian as <kinetic> and <potential>"},
    {"kineticEnergy", "write <kinetic>"},
    {"potentialEnergy", "write <potential>"},
    {"damper", "write <spring from=\"...\" to=\"...\" damping=\"...\"/>, or <dissipation>b*v^2/2</dissipation>"},
    {"damping", "write <dissipation>b*v^2/2</dissipation>"},
    {"mass", "write <particle mass=\"m\" x=\"...\"/>, or <body> with an inertia and an angle"},
    {"link", "write <frame> and a <body> in it"},
    {"variable", "write <parameter>, <input>, <coordinate>, <define> or <output>"},
    {"import", "write <include file=\"...\" as=\"...\"/> for another system as a part of this one"},
    {"system", "write <include file=\"...\" as=\"...\"/> for another system as a part of this one"},
    {"subsystem", "write <include file=\"...\" as=\"...\"/> for another system as a part of this one"},
    {"component", "write <include file=\"...\" as=\"...\"/> for another system as a part of this one"},
    {"lookup", "write <table name=\"...\">, whose name is a function in expressions"},
    {"curve", "write <table name=\"...\">, whose name is a function in expressions"},
    {"array", "write <parameter name=\"m\" values=\"1 2 3\"/> for m[1], m[2] and m[3]"},
    {"vector", "write <parameter name=\"m\" values=\"1 2 3\"/> for m[1], m[2] and m[3]"},
    {"collision",
     "write <contact gap=\"...\" restitution=\"...\"/>, or <contact between=\"...\" and=\"...\"/> of <shape>s"},
    {"geometry", "write <shape type=\"...\"/>"},
    {"sphere", "write <shape type=\"sphere\" radius=\"...\"/>"},
    {"box", "write <shape type=\"box\" sizeX=\"...\" sizeY=\"...\" sizeZ=\"...\"/>"},
    {"ground", "write <shape type=\"plane\"/> and a <contact between=\"...\" and=\"...\"/>"},
    {"motor", "write <input name=\"tau\"/> and <force coordinate=\"...\">tau</force>, or <torque>"},
    {"torsion", "write <potential>k*theta^2/2</potential>, or a <bushing> with torsion"},
    {"impact", "write <contact gap=\"...\" restitution=\"...\"/>"},
    {"limit", "write <stop coordinate=\"...\" min=\"...\" max=\"...\"/>"},
    {"when", "write <event when=\"...\"> with <set> in it"},
    {"clock", "write <sample every=\"...\"> with <set> in it"},
    {"sampler", "write <sample every=\"...\"> with <set> in it"},
    {"integrator", "write <state name=\"z\" rate=\"...\"/>"},
    {"filter", "write <state name=\"z\" rate=\"(u - z)/T\"/>"},
};

/* Returns the hint for a word in the list; "" for none. */
static const char *look_up(const struct Hint *list, size_t count, const char *text) {
  for (size_t i = 0; i < count; i++)
    if (strcmp(text, list[i].written) == 0) return list[i].hint;
  return "";
}

const char *hint_for_name(const char *name) {
  size_t length = strlen(name);
  if (length > 3 && strcmp(name + length - 3, "dot") == 0) return "; write der(...) for a time derivative";
  return look_up(of_names, sizeof of_names / sizeof *of_names, name);
}

const char *hint_for_element(const char *name) {
  return look_up(of_elements, sizeof of_elements / sizeof *of_elements, name);
}

/* True if the text is a comma or apostrophe between digits, as a decimal comma or between thousands. */
static bool is_separator(const char *begin, const char *next) {
  return next > begin && isdigit((unsigned char)next[-1]) && (*next == ',' || *next == '\'') &&
         isdigit((unsigned char)next[1]);
}

const char *hint_for_text(const char *begin, const char *next) {
  if (is_separator(begin, next))
    return "; write a point in numbers, as in 9.81, and nothing between thousands, as in 1000";
  if (next > begin && isdigit((unsigned char)*next) && next[-1] == ' ')
    return "; write * for a product, and nothing between thousands, as in 1000";
  if (strncmp(next, "deg", 3) == 0 && next > begin) return "; write radians, as in 30*pi/180";
  if (strncmp(next, "mod ", 4) == 0) return "; write mod(a, b)";
  if (strncmp(next, "AND ", 4) == 0 || strncmp(next, "OR ", 3) == 0) return "; write and, or in small letters";
  if (next > begin && isalpha((unsigned char)*next) && next[-1] == ' ')
    return "; write * for a product, and units in unit=\"...\"";
  for (size_t i = 0; i < sizeof of_text / sizeof *of_text; i++)
    if (strncmp(next, of_text[i].written, strlen(of_text[i].written)) == 0) return of_text[i].hint;
  return ((unsigned char)*next & 0x80u) != 0 ? "; names consist of letters a to z, digits and _" : "";
}

const char *hint_for_function(const char *name) {
  return look_up(of_functions, sizeof of_functions / sizeof *of_functions, name);
}

const char *hint_for_kind(enum SymbolKind kind, unsigned allowed) {
  allowed &= ~(1u << MODE);
  if (allowed == 0 && (kind == MODE || kind == PARAMETER))
    return "; expected numbers and constants; choose by if(i > 1.5, c[2], c[1])";
  if (allowed == 0) return "; expected numbers and constants";
  if (allowed == (1u << PARAMETER | 1u << TIME | 1u << INPUT)) return "; expected inputs, parameters and time";
  if (allowed == 1u << PARAMETER) return "; expected numbers and parameters";
  switch (kind) {
  case INPUT: return "; use it in a <force>";
  case STATE: return "; expected it in a force, a potential, a rate, an event or an output";
  case VELOCITY: return "; expected positions of coordinates and time, from which velocities follow";
  case DISPLACEMENT: return "; expected it in positions, angles, energies and forces";
  case REACTION: return "; expected it in an <output>";
  case ACCELERATION: return "; expected them in an <output> alone: inertia belongs in masses and <kinetic>";
  default: return "";
  }
}
