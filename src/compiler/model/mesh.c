#include "model/mesh.h"

#include <math.h>

double mesh_side(const struct Mesh *mesh, double least[3]) {
  double side = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double most = least[axis] = mesh->points[0][axis];
    for (size_t i = 0; i < mesh->point_count; i++) {
      least[axis] = fmin(least[axis], mesh->points[i][axis]);
      most = fmax(most, mesh->points[i][axis]);
    }
    side = fmax(side, most - least[axis]);
  }
  return side;
}
