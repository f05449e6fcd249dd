#include "glyphs.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

static const char *const greek[][2] = {{"alpha", "α"}, {"beta", "β"},  {"gamma", "γ"}, {"delta", "δ"}, {"epsilon", "ε"},
                                       {"zeta", "ζ"},  {"eta", "η"},   {"theta", "θ"}, {"kappa", "κ"}, {"lambda", "λ"},
                                       {"mu", "μ"},    {"nu", "ν"},    {"xi", "ξ"},    {"pi", "π"},    {"rho", "ρ"},
                                       {"sigma", "σ"}, {"tau", "τ"},   {"phi", "φ"},   {"chi", "χ"},   {"psi", "ψ"},
                                       {"omega", "ω"}, {"Gamma", "Γ"}, {"Delta", "Δ"}, {"Theta", "Θ"}, {"Lambda", "Λ"},
                                       {"Sigma", "Σ"}, {"Phi", "Φ"},   {"Psi", "Ψ"},   {"Omega", "Ω"}};

/* Indices of a name that are shown. */
enum { INDEX_LIMIT = 4 };

/* A part of a name. */
struct NamePart {
  const char *text;
  size_t length;
};

/* A letter or word with its indices: a word, numbers, and the part of the system. */
struct Glyphs {
  struct NamePart base, indices[INDEX_LIMIT];
  size_t index_count;
};

/* Returns the letter of a Greek name; NULL for other names. */
static const char *greek_letter(struct NamePart name) {
  for (size_t i = 0; i < sizeof greek / sizeof *greek; i++)
    if (strlen(greek[i][0]) == name.length && memcmp(greek[i][0], name.text, name.length) == 0) return greek[i][1];
  return NULL;
}

static void add_index(struct Glyphs *glyphs, const char *text, size_t length) {
  if (length > 0 && glyphs->index_count < INDEX_LIMIT)
    glyphs->indices[glyphs->index_count++] = (struct NamePart){text, length};
}

/* Splits names such as x_end, omegaCoupler and rhoA into base and index. */
static void split_word(struct Glyphs *glyphs) {
  struct NamePart *base = &glyphs->base;
  const char *text = base->text;
  for (size_t i = 1; i < base->length; i++) {
    bool underscore = text[i] == '_' && i + 1 < base->length;
    bool capital = isupper((unsigned char)text[i]) && greek_letter((struct NamePart){text, i}) != NULL;
    if (!underscore && !capital) continue;
    size_t start = underscore ? i + 1 : i;
    add_index(glyphs, text + start, base->length - start);
    base->length = i;
    return;
  }
}

static struct Glyphs glyphs_of(const char *name) {
  struct Glyphs glyphs = {.index_count = 0};
  const char *dot = strrchr(name, '.'), *text = dot != NULL ? dot + 1 : name;
  size_t part = dot != NULL ? (size_t)(dot - name) : 0, length = strcspn(text, "["), digits = length;
  const char *bracket = text[length] == '[' ? text + length + 1 : NULL;
  if (bracket == NULL)
    while (digits > 0 && isdigit((unsigned char)text[digits - 1])) digits--;
  if (digits == 0 || text[digits - 1] == '_') digits = length;
  glyphs.base = (struct NamePart){text, digits};
  split_word(&glyphs);
  add_index(&glyphs, text + digits, length - digits);
  if (bracket != NULL) add_index(&glyphs, bracket, strcspn(bracket, "]"));
  add_index(&glyphs, name, part);
  if (part > 0 && length == strlen("force") && strncmp(text, "force", length) == 0)
    glyphs.base = (struct NamePart){"F", 1};
  return glyphs;
}

static void write_base(FILE *file, struct NamePart base, int dots) {
  static const char *const accents[] = {"", "<mo>˙</mo></mover>", "<mo>¨</mo></mover>"};
  const char *letter = greek_letter(base);
  if (dots > 0) fputs("<mover accent=\"true\">", file);
  if (letter != NULL) fprintf(file, "<mi>%s</mi>", letter);
  else fprintf(file, "<mi>%.*s</mi>", (int)base.length, base.text);
  fputs(accents[dots], file);
}

void glyphs_write(FILE *file, const char *name, int dots) {
  struct Glyphs glyphs = glyphs_of(name);
  if (glyphs.index_count > 0) fputs("<msub>", file);
  write_base(file, glyphs.base, dots);
  if (glyphs.index_count == 0) return;
  fputs("<mrow>", file);
  for (size_t i = 0; i < glyphs.index_count; i++) {
    struct NamePart index = glyphs.indices[i];
    const char *element = isdigit((unsigned char)*index.text) ? "mn" : "mtext";
    fprintf(file, "%s<%s>%.*s</%s>", i > 0 ? "<mo>,</mo>" : "", element, (int)index.length, index.text, element);
  }
  fputs("</mrow></msub>", file);
}

double glyphs_width(const char *name) {
  struct Glyphs glyphs = glyphs_of(name);
  double width = greek_letter(glyphs.base) != NULL ? 1.0 : (double)glyphs.base.length;
  for (size_t i = 0; i < glyphs.index_count; i++) width += 0.7 * (double)glyphs.indices[i].length;
  return width;
}
