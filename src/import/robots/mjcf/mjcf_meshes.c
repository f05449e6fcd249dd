/*
 * Mass properties of a solid bounded by triangles. Each triangle with corners a, b, c relative to a common apex is a
 * tetrahedron of signed volume V = det(a, b, c)/6. The sums over all triangles of
 *
 *   V,   V (a + b + c)/4,   V ((a + b + c)(a + b + c)^T + a a^T + b b^T + c c^T)/20
 *
 * are the volume, its first and its second moments S about the apex (divergence theorem). The tensor is trace(S) 1 - S
 * with the apex at the centre of mass. For a closed surface the signs make the result exact ("exact" in MuJoCo); a
 * surface that is inside out only changes the overall sign. MuJoCo's "legacy" adds |V| with the apex at the centroid of
 * the surface, which is the same for solids that are star-shaped about it. The cost is linear in the number of
 * triangles.
 *
 * B. Mirtich, Fast and accurate computation of polyhedral mass properties, J. Graphics Tools 1 (1996).
 */
#include "robots/mjcf/mjcf_meshes.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/paths.h"
#include "model/hull.h"
#include "meshes/mesh_file.h"
#include "meshes/package_path.h"
#include "robots/expansion/mjcf_names.h"
#include "xml/nodes.h"

/*
 * The tetrahedron over a triangle: corners relative to the apex, and signed volume, negative if the apex lies on the
 * outer side of the face.
 */
struct Pyramid {
  double corners[3][3], volume;
};

static struct Pyramid pyramid_on(const struct Mesh *mesh, size_t triangle, const double apex[3]) {
  struct Pyramid pyramid;
  double(*c)[3] = pyramid.corners;
  for (int i = 0; i < 3; i++)
    for (int axis = 0; axis < 3; axis++) c[i][axis] = mesh->points[mesh->triangles[triangle][i]][axis] - apex[axis];
  pyramid.volume = 0;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    pyramid.volume += c[0][i] * (c[1][j] * c[2][k] - c[1][k] * c[2][j]) / 6;
  }
  return pyramid;
}

/* Sets the centroid of the surface, each triangle weighted by its area. */
static void find_surface_center(const struct Mesh *mesh, double center[3]) {
  static const double origin[3];
  double area = 0, sum[3] = {0};
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    struct Pyramid pyramid = pyramid_on(mesh, i, origin);
    double(*c)[3] = pyramid.corners, square = 0;
    for (int axis = 0; axis < 3; axis++) {
      int j = (axis + 1) % 3, k = (axis + 2) % 3;
      double along = (c[1][j] - c[0][j]) * (c[2][k] - c[0][k]) - (c[1][k] - c[0][k]) * (c[2][j] - c[0][j]);
      square += along * along;
    }
    area += sqrt(square) / 2;
    for (int axis = 0; axis < 3; axis++) sum[axis] += sqrt(square) / 2 * (c[0][axis] + c[1][axis] + c[2][axis]) / 3;
  }
  for (int axis = 0; axis < 3; axis++) center[axis] = area > 0 ? sum[axis] / area : 0;
}

/* Returns the mass of a tetrahedron at density 1. */
static double mass_of(const struct Pyramid *pyramid, bool is_exact) {
  return is_exact ? pyramid->volume : fabs(pyramid->volume);
}

/* Moves center, the apex, to the centre of mass of all tetrahedra. Returns their mass. */
static double find_center(const struct Mesh *mesh, bool is_exact, double center[3]) {
  double mass = 0, sum[3] = {0};
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    struct Pyramid pyramid = pyramid_on(mesh, i, center);
    double(*c)[3] = pyramid.corners, share = mass_of(&pyramid, is_exact);
    mass += share;
    for (int axis = 0; axis < 3; axis++) sum[axis] += share * (c[0][axis] + c[1][axis] + c[2][axis]) / 4;
  }
  for (int axis = 0; axis < 3 && mass != 0; axis++) center[axis] += sum[axis] / mass;
  return mass;
}

/* Sets the body at density 1. Returns false if it has no positive mass or its numbers are not finite. */
static bool weigh_mesh(const struct Mesh *mesh, bool is_exact, struct RigidBody *body) {
  double moments[3][3] = {{0}}, mass = 0;
  find_surface_center(mesh, body->center);
  if (find_center(mesh, is_exact, body->center) == 0) return false;
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    struct Pyramid pyramid = pyramid_on(mesh, i, body->center);
    double(*c)[3] = pyramid.corners, share = mass_of(&pyramid, is_exact);
    mass += share;
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++) {
        double product = (c[0][j] + c[1][j] + c[2][j]) * (c[0][k] + c[1][k] + c[2][k]);
        for (int corner = 0; corner < 3; corner++) product += c[corner][j] * c[corner][k];
        moments[j][k] += share * product / 20;
      }
  }
  double sign = mass < 0 ? -1 : 1, sum = moments[0][0] + moments[1][1] + moments[2][2];
  body->mass = sign * mass;
  for (int j = 0; j < 3; j++)
    for (int k = 0; k < 3; k++) body->tensor.at[j][k] = sign * ((j == k ? sum : 0) - moments[j][k]);
  return body->mass > 0 && body_is_finite(body);
}

/* Returns the path of the asset's file; NULL if it does not exist, with mesh->problem set. */
static char *find_file(struct Mjcf *mjcf, xmlNodePtr asset, struct MjcfMesh *mesh) {
  const char *robot = mjcf->file.diagnostics->file, *file = mjcf_text(mjcf, asset, "file");
  if (file == NULL) {
    mesh->problem = copy_text("a <mesh> has no file; expected an STL, OBJ or MSH file");
    return NULL;
  }
  const struct MjcfCompiler *compiler = mjcf_compiler(mjcf, asset);
  bool is_in_folder = compiler->mesh_folder != NULL && file[0] != '/';
  char *named = is_in_folder ? format_text("%s/%s", compiler->mesh_folder, file) : copy_text(file);
  if (compiler->file != NULL) named = path_beside_file(compiler->file, named);
  char *path = path_in_package(robot, named);
  if (path == NULL)
    mesh->problem =
        format_text("the mesh '%s' does not exist; expected a path relative to this file, or to its meshdir", named);
  return path;
}

static void read_mesh(struct Mjcf *mjcf, xmlNodePtr asset, struct MjcfMesh *mesh) {
  static const char *const kinds[] = {"legacy", "exact", "convex", "shell", NULL};
  for (int i = 0; i < 3; i++) mesh->scale[i] = 1;
  mjcf_numbers(mjcf, asset, "scale", 3, 3, mesh->scale);
  mjcf_reject(mjcf, asset, "refpos refquat");
  size_t kind = mjcf_word(mjcf, asset, "inertia", kinds);
  mesh->path = find_file(mjcf, asset, mesh);
  if (mesh->path == NULL) return;
  struct Mesh *read =
      mesh_read(path_beside_file(mjcf->file.diagnostics->file, mesh->path), mesh->scale, &mesh->problem);
  if (read == NULL) return;
  mesh->is_weighed = kind <= 1 && weigh_mesh(read, kind == 1, &mesh->body);
  mesh->is_flat = mjcf->file.options->has_ground && !mesh_find_corners(read);
  release(read->points);
  release(read->triangles);
}

/* True if the asset has this name. The default is its file's name without folders and ending. */
static bool is_named(const struct Mjcf *mjcf, xmlNodePtr asset, const char *name) {
  if (has_attribute(asset, "name")) return attribute_is(asset, "name", name);
  const char *file = mjcf_text(mjcf, asset, "file");
  return file != NULL && strcmp(mjcf_asset_name(file), name) == 0;
}

static xmlNodePtr find_asset(const struct Mjcf *mjcf, const char *name) {
  for (xmlNodePtr section = mjcf->root->children; section != NULL; section = section->next)
    for (xmlNodePtr asset = is_element(section, "asset") ? section->children : NULL; asset != NULL; asset = asset->next)
      if (is_element(asset, "mesh") && is_named(mjcf, asset, name)) return asset;
  return NULL;
}

const struct MjcfMesh *mjcf_mesh(struct Mjcf *mjcf, xmlNodePtr node, const char *name) {
  struct MjcfMesh *mesh = names_find(mjcf->meshes, name);
  if (mesh != NULL) return mesh;
  xmlNodePtr asset = find_asset(mjcf, name);
  if (asset == NULL) {
    mjcf_error(mjcf, node, "there is no <mesh> '%s' in an <asset>; expected an existing name", name);
    return NULL;
  }
  mesh = allocate(1, sizeof *mesh);
  read_mesh(mjcf, asset, mesh);
  names_set(mjcf->meshes, name, mesh);
  return mesh;
}
