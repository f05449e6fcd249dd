#include "algebra/domain.h"

#include <math.h>
#include <string.h>

#include "algebra/functions.h"
#include "base/memory.h"

bool domain_contains(enum Operation operation, double argument) {
  const struct Domain *domain = &functions[operation].domain;
  switch (domain->kind) {
  case EVERYWHERE: return true;
  case CLOSED: return domain->low <= argument && argument <= domain->high;
  case OPEN: return domain->low < argument && argument < domain->high;
  }
  return true;
}

const char *domain_text(enum Operation operation) {
  const char *text = functions[operation].domain_text;
  return text != NULL ? text : "nearer to 0"; /* the function overflows */
}

void require_domain(struct Requirements *requirements, const struct Graph *graph, enum Operation operation,
                    Node argument, long line) {
  if (graph_is_constant(graph, argument) || functions[operation].domain.kind == EVERYWHERE) return;
  APPEND(requirements->items, requirements->count, (struct Requirement){operation, argument, line});
}

void warn_outside_domains(const struct Requirements *requirements, const struct Graph *graph, const double *values,
                          const struct Diagnostics *diagnostics) {
  long reported[OPERATION_COUNT];
  memset(reported, 0xff, sizeof reported);
  for (size_t i = 0; i < requirements->count; i++) {
    const struct Requirement *requirement = &requirements->items[i];
    double value = values[requirement->argument];
    bool unknown = graph_depends_on(graph, requirement->argument, ACCELERATION) ||
                   graph_depends_on(graph, requirement->argument, REACTION);
    if (unknown || isnan(value) || domain_contains(requirement->operation, value) ||
        reported[requirement->operation] == requirement->line)
      continue;
    reported[requirement->operation] = requirement->line;
    if (requirement->operation == POWER)
      report_warning(diagnostics, requirement->line,
                     "the base of a root or fractional power is %g at the start values; expected one %s", value,
                     domain_text(POWER));
    else
      report_warning(diagnostics, requirement->line,
                     "%s(%g) has no finite value at the start values; expected an argument %s",
                     operation_name(requirement->operation), value, domain_text(requirement->operation));
  }
}
