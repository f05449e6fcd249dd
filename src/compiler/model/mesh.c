#include "model/mesh.h"

#include <math.h>

double mesh_size(const struct Mesh *mesh, double least[3]) {
  double size = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double most = least[axis] = mesh->points[0][axis];
    for (size_t i = 0; i < mesh->point_count; i++) {
      least[axis] = fmin(least[axis], mesh->points[i][axis]);
      most = fmax(most, mesh->points[i][axis]);
    }
    size = fmax(size, most - least[axis]);
  }
  return size;
}
