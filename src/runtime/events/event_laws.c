#include "instance/event_laws.h"

#include <string.h>

#include "events/branches.h"
#include "events/exchange.h"
#include "events/passing.h"
#include "events/resolution.h"

static bool holds_at_times(const char *constraint) {
  const struct SwitchTable *switches = lagrangian.switches;
  bool is_switched = false;
  for (size_t i = 0; i < switches->contact_count; i++)
    is_switched |= strcmp(switches->contacts[i].name, constraint) == 0;
  for (size_t i = 0; i < switches->friction_count; i++)
    is_switched |= strcmp(switches->frictions[i].name, constraint) == 0;
  return is_switched;
}

const struct EventLaws event_laws = {.work_count = resolution_work_count,
                                     .resolve = exchange_resolve,
                                     .guess = branches_guess,
                                     .start = events_start,
                                     .part = events_part,
                                     .resolve_change = events_resolve_change,
                                     .update = events_update,
                                     .pass = events_pass,
                                     .pass_barrier = events_pass_barrier,
                                     .explain = events_explain,
                                     .explain_stop = events_explain_stop,
                                     .holds_at_times = holds_at_times,
                                     .check = events_check,
                                     .return_to_domain = exchange_return_to_domain,
                                     .indicators = exchange_indicators,
                                     .is_due = exchange_is_due};
