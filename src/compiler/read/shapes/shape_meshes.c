#include "read/shapes/shape_meshes.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "read/context/includes.h"
#include "model/hull.h"
#include "meshes/mesh_file.h"
#include "names/names.h"

/* Reads one factor for all axes, or three. */
static bool read_scale(struct Reader *reader, xmlNodePtr node, double scale[3]) {
  static const char blanks[] = " \t\r\n";
  char *text = attribute(node, "scale");
  size_t count = 0;
  bool is_right = true;
  int errors = reader->diagnostics->errors;
  for (int i = 0; i < 3; i++) scale[i] = 1.0;
  if (text == NULL) return true;
  for (text += strspn(text, blanks); *text != '\0' && is_right; text += strspn(text, blanks)) {
    size_t length = strcspn(text, blanks);
    char *word = format_text("%.*s", (int)length, text);
    is_right = count < 3 && number_in(reader, node, "scale", word, &scale[count < 3 ? count : 2]);
    is_right = is_right && isfinite(scale[count]) && scale[count] != 0.0;
    count++;
    text += length;
  }
  if (count == 1) scale[1] = scale[2] = scale[0];
  is_right = is_right && (count == 1 || count == 3);
  if (!is_right && reader->diagnostics->errors == errors)
    report_at(
        reader, node,
        "scale=\"%.60s\" of <shape> is not valid; expected a number other than 0, or three of them such as 1 1 -1",
        attribute(node, "scale"));
  return is_right;
}

struct Mesh *mesh_of_shape(struct Reader *reader, xmlNodePtr node) {
  double scale[3];
  char *file = attribute(node, "file"), *problem = NULL;
  if (file == NULL || !read_scale(reader, node, scale)) return NULL;
  char *path = path_beside(reader, file);
  char *key = format_text("%s\n%a %a %a", path, scale[0], scale[1], scale[2]);
  if (reader->meshes == NULL) reader->meshes = names_create();
  struct Mesh *mesh = names_find(reader->meshes, key);
  if (mesh != NULL) return mesh;
  mesh = mesh_read(path, scale, &problem);
  if (mesh != NULL) names_set(reader->meshes, key, mesh);
  else report_at(reader, node, "%s", problem);
  return mesh;
}

static void note_coarse_mesh(struct CoarseMeshes *meshes, const struct ContactShape *shape, long line) {
  double residual = shape->mesh->residual;
  if (meshes->count++ == 0 || residual > meshes->residual) {
    meshes->shape = shape->name;
    meshes->line = line;
    meshes->residual = residual;
  }
}

bool prepare_corners(struct Reader *reader, xmlNodePtr node, const struct ContactShape *shape) {
  struct Mesh *mesh = shape->mesh;
  if (shape->type != SHAPE_MESH || (mesh != NULL && mesh->corner_count > 0)) return true;
  if (mesh == NULL) return false; /* the error has been reported */
  if (!mesh_find_corners(mesh)) {
    report_at(
        reader, node,
        "the mesh of the shape '%s' is flat, and cannot touch; expected one with a volume, or a box without a size "
        "along an axis",
        shape->name);
    return false;
  }
  if (mesh->corner_count == MOST_CORNERS && mesh->residual > 0.0)
    note_coarse_mesh(&reader->coarse_meshes, shape, note_line(reader->diagnostics, line_of(node)));
  return true;
}

void warn_of_coarse_meshes(const struct Reader *reader) {
  const struct CoarseMeshes *meshes = &reader->coarse_meshes;
  if (meshes->count == 0) return;
  size_t others = meshes->count - 1;
  report_warning(reader->diagnostics, meshes->line,
                 "the convex hull of the shape '%s'%s has many corners, and touches at %d of them; it reaches up to "
                 "%.2g m beyond these",
                 meshes->shape,
                 others > 0 ? format_text(" and of %zu other mesh%s", others, others > 1 ? "es" : "") : "",
                 MOST_CORNERS, meshes->residual);
}
