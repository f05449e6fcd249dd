#include "algebra/domain.h"

#include <math.h>
#include <string.h>

#include "memory.h"

bool domain_contains(enum Operation operation, double argument) {
  switch (operation) {
  case POWER: return argument >= 0;
  case LOGARITHM: return argument > 0;
  case ARCSINE:
  case ARCCOSINE: return fabs(argument) <= 1;
  case ARCOSH: return argument >= 1;
  case ARTANH: return fabs(argument) < 1;
  default: return true;
  }
}

const char *domain_text(enum Operation operation) {
  switch (operation) {
  case POWER: return "that is not negative";
  case LOGARITHM: return "that is positive";
  case ARCSINE:
  case ARCCOSINE: return "from -1 to 1";
  case ARCOSH: return "of 1 or more";
  case ARTANH: return "between -1 and 1";
  case TANGENT: return "between its poles";
  default: return "nearer to 0"; /* of what overflows */
  }
}

void require_domain(struct Requirements *requirements, const struct Graph *graph, enum Operation operation,
                    Node argument, long line) {
  if (graph_is_constant(graph, argument) || domain_contains(operation, NAN)) return;
  requirements->items = reallocate(requirements->items, requirements->count + 1, sizeof *requirements->items);
  requirements->items[requirements->count++] = (struct Requirement){operation, argument, line};
}

void warn_outside_domains(const struct Requirements *requirements, const struct Graph *graph, const double *values,
                          const struct Diagnostics *diagnostics) {
  long told[OPERATION_COUNT];
  memset(told, 0xff, sizeof told);
  for (size_t i = 0; i < requirements->count; i++) {
    const struct Requirement *requirement = &requirements->items[i];
    double value = values[requirement->argument];
    if (graph_depends_on(graph, requirement->argument, ACCELERATION) || isnan(value) ||
        domain_contains(requirement->operation, value) || told[requirement->operation] == requirement->line)
      continue;
    told[requirement->operation] = requirement->line;
    if (requirement->operation == POWER)
      report_warning(diagnostics, requirement->line,
                     "a root or fractional power of %g at the start values; expected a base %s", value,
                     domain_text(POWER));
    else
      report_warning(diagnostics, requirement->line, "%s(%g) at the start values; expected an argument %s",
                     operation_name(requirement->operation), value, domain_text(requirement->operation));
  }
}
