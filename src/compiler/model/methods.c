#include "model/methods.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"

static const struct Method methods[] = {
    {.name = "taylor",
     .solver = "taylor",
     .sentence = "Co-simulation integrates with Taylor series of the motion, of an order that follows from the "
                 "tolerance; a step depends only on the state that the FMU saves, so that a repeated step gives the "
                 "same bits. Each step is checked by its residual in the equations of motion, and is so short that it "
                 "skips no peak, jump or pulse of a function in them (exp, tanh, powers, quotients, ...), however "
                 "narrow. abs, min, max and sign are followed piece by piece. A point where the equations have no "
                 "solution and a stiff system end in fmi2Discard with a message that names them.",
     .evaluations = "series of the equations of motion",
     .sources = {"methods/taylor_interval.c", "support/series_limit.c"},
     .series = ALL_TERMS},
    {.name = "erk",
     .solver = "erk",
     .sentence = "Co-simulation integrates with Dormand and Prince's method of order 5(4); a step depends only on the "
                 "state that the FMU saves, so that a repeated step gives the same bits.",
     .evaluations = "evaluations of the equations of motion",
     .sources = {"methods/sundials/sundials_support.c", "methods/sundials/sundials_memory.c", "methods/first_terms.c",
                 "support/series_limit.c"},
     .series = FIRST_TERMS,
     .uses_library = true},
    {.name = "bdf",
     .solver = "bdf",
     .sparse_solver = "bdf_sparse",
     .sentence = "Co-simulation integrates with backward differentiation formulas of variable order; they keep a "
                 "history, so that a step from a restored state agrees within the tolerance, not bit by bit.",
     .evaluations = "evaluations of the equations of motion",
     .sources = {"methods/sundials/bdf_support.c", "methods/sundials/sundials_support.c",
                 "methods/sundials/sundials_memory.c", "methods/first_terms.c", "support/series_limit.c"},
     .series = FIRST_TERMS,
     .needs_jacobian = true,
     .uses_library = true},
    {.name = "radau",
     .solver = "radau",
     .sentence =
         "Co-simulation integrates with Radau IIA methods of order 5, 9 or 13, by the tolerance; they are implicit, "
         "for stiff systems. A step depends only on the state that the FMU saves, so that a repeated step gives "
         "the same bits.",
     .evaluations = "evaluations of the equations of motion",
     .sources = {"methods/radau_systems.c", "methods/first_terms.c", "support/series_limit.c"},
     .series = FIRST_TERMS,
     .needs_jacobian = true,
     .factors = true},
    {.name = "auto",
     .solver = "auto",
     .sentence =
         "Co-simulation integrates with Taylor series of the motion and, where the system is stiff, with Radau IIA "
         "methods of order 5, 9 or 13. A step depends only on the state that the FMU saves, so that a repeated step "
         "gives the same bits. Each step is checked by its residual in the equations of motion, and is so short that "
         "it skips no peak, jump or pulse of a function in them (exp, tanh, powers, quotients, ...), however narrow. A "
         "point where the equations have no solution ends in fmi2Discard with a message that names it.",
     .evaluations = "series of the equations of motion, and evaluations of them",
     .sources = {"methods/stiffness.c", "methods/taylor.c", "methods/taylor_interval.c", "methods/radau.c",
                 "methods/radau_systems.c", "methods/first_terms.c", "support/series_limit.c"},
     .series = ALL_TERMS,
     .needs_jacobian = true,
     .factors = true,
     .hands_over = true},
    {.name = "exact",
     .solver = "exact",
     .sentence = "Co-simulation advances with the matrix exponential, exactly for inputs that are polynomials of time "
                 "over the communication step.",
     .needs_linear = true},
};
enum { METHOD_COUNT = sizeof methods / sizeof *methods };

const struct Method *method_named(const char *name) {
  for (size_t i = 0; i < METHOD_COUNT; i++)
    if (strcmp(name, methods[i].name) == 0) return &methods[i];
  return NULL;
}

char *method_names(void) {
  struct TextStream text;
  FILE *file = open_text(&text);
  for (size_t i = 0; i < METHOD_COUNT; i++)
    fprintf(file, "%s%s", i == 0 ? "" : i + 1 == METHOD_COUNT ? " or " : ", ", methods[i].name);
  return close_text(&text);
}

/*
 * KLU was measured on rows of masses, springs and dampers: faster from 20 states on, and twice as fast at 40. So a
 * sparse solver is chosen from 40 rows on.
 */
const char *method_solver(const struct Method *method, size_t rows, size_t elements) {
  bool is_sparse = rows >= 40 && elements < rows * rows / 8;
  return is_sparse && method->sparse_solver != NULL ? method->sparse_solver : method->solver;
}
