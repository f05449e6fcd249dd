#include "model/switches.h"

#include "algebra/simplify.h"
#include "base/memory.h"

void append_switch(struct Switches *switches, struct Switch item) {
  switches->items = make_room(switches->items, switches->count, sizeof *switches->items);
  switches->items[switches->count++] = item;
}

bool has_switches(const struct Switches *switches) {
  return switches->count + switches->contact_count + switches->friction_count > 0;
}

Node friction_force(struct Graph *graph, const struct Friction *friction, Node force) {
  Node sliding = multiply(graph, friction->mode, friction->sliding);
  return choose_node(graph, power_number(graph, friction->mode, 2.0), sliding, force);
}
