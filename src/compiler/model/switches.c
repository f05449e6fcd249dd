#include "model/switches.h"

#include "algebra/simplify.h"
#include "base/memory.h"

void append_branch(struct Switches *switches, struct Branch branch) {
  switches->branches = make_room(switches->branches, switches->branch_count, sizeof *switches->branches);
  switches->branches[switches->branch_count++] = branch;
}

bool has_switches(const struct Switches *switches) {
  return switches->branch_count + switches->contact_count + switches->friction_count > 0;
}

Node friction_force(struct Graph *graph, const struct Friction *friction, Node force) {
  Node sliding = multiply(graph, friction->mode, friction->sliding);
  return choose_node(graph, power_number(graph, friction->mode, 2.0), sliding, force);
}
