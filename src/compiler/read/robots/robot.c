#include "read/robots/robot.h"

#include <stdlib.h>

static void link_free(struct Link *link) {
  free(link->name);
  free(link->symbol);
  free(link);
}

static void joint_free(struct Joint *joint) {
  free(joint->name);
  free(joint->symbol);
  free(joint->parent_name);
  free(joint->child_name);
  free(joint->mimicked_name);
  free(joint);
}

void robot_free(struct Robot *robot) {
  for (size_t i = 0; i < robot->link_count; i++) link_free(robot->links[i]);
  for (size_t i = 0; i < robot->joint_count; i++) joint_free(robot->joints[i]);
  free(robot->links);
  free(robot->joints);
  free(robot->name);
  free(robot);
}
