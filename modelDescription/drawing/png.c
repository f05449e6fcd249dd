/*
 * A rasterizer and a PNG writer (ISO/IEC 15948). The coverage of a pixel by a shape follows from the signed
 * distance of its centre to the edge. Clamped to one pixel, it gives smooth edges. Each shape costs its bounding
 * box times its lines. The image is stored without compression (RFC 1950, RFC 1951), as the FMU's archive
 * compresses it.
 */
#include "png.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/memory.h"

enum { SIDE = 128, ROW = 1 + 3 * SIDE, IMAGE = SIDE * ROW }; /* each row begins with its filter type 0 */

/* --- Pixels -------------------------------------------------------------------------------------------------------- */

/* Returns the distance from a point to a segment, which may be a point. */
static double distance_to_line(struct PicturePoint point, struct PicturePoint from, struct PicturePoint to) {
  double right = to.right - from.right, up = to.up - from.up, length = right * right + up * up;
  double along = length > 0.0 ? ((point.right - from.right) * right + (point.up - from.up) * up) / length : 0.0;
  along = fmin(fmax(along, 0.0), 1.0);
  return hypot(point.right - from.right - along * right, point.up - from.up - along * up);
}

/* Returns the distance to the nearest segment of a shape; a polygon is closed. is_inside: for convex polygons. */
static double distance_to_shape(const struct PictureShape *shape, struct PicturePoint point, bool *is_inside) {
  double distance = INFINITY;
  bool has_left = false, has_right = false;
  size_t lines = shape->count == 1 || shape->is_filled ? shape->count : shape->count - 1;
  for (size_t i = 0; i < lines; i++) {
    struct PicturePoint from = shape->points[i], to = shape->points[(i + 1) % shape->count];
    double side = (to.right - from.right) * (point.up - from.up) - (to.up - from.up) * (point.right - from.right);
    has_left |= side > 0.0;
    has_right |= side < 0.0;
    distance = fmin(distance, distance_to_line(point, from, to));
  }
  *is_inside = shape->is_filled && shape->count > 2 && has_left != has_right;
  return distance;
}

/* Returns the share of a pixel that the shape covers, in quarters, which compress well, times its opacity. */
static double coverage(const struct PictureShape *shape, struct PicturePoint point) {
  const double scale = (double)SIDE / PICTURE_SIZE;
  const struct LookStyle *style = &looks[shape->look];
  bool is_polygon = shape->is_filled && shape->count > 1, is_inside;
  double distance = distance_to_shape(shape, point, &is_inside);
  double beyond = is_polygon ? (is_inside ? -distance : distance) : distance - fmax(style->width / 2.0, 0.5 / scale);
  return round(4.0 * fmin(fmax(0.5 - scale * beyond, 0.0), 1.0)) / 4.0 * (is_polygon ? style->opacity : 1.0);
}

static void paint(unsigned char *pixel, const unsigned char *colour, double share) {
  for (int i = 0; i < 3; i++) pixel[i] = (unsigned char)lround(pixel[i] + share * (colour[i] - pixel[i]));
}

static double clip(double coordinate) {
  return fmin(fmax(coordinate, 0.0), SIDE);
}

/* Paints a shape, within its bounding box. */
static void paint_shape(unsigned char *image, const struct PictureShape *shape) {
  const double scale = (double)SIDE / PICTURE_SIZE, width = looks[shape->look].width + 2.0;
  struct Rectangle all = rectangle_of(&(struct Drawing){.shapes = (struct PictureShape *)shape, .count = 1});
  for (int row = (int)clip(scale * (all.least.up - width)); row < clip(scale * (all.most.up + width)); row++)
    for (int column = (int)clip(scale * (all.least.right - width)); column < clip(scale * (all.most.right + width));
         column++) {
      struct PicturePoint point = {(column + 0.5) / scale, (row + 0.5) / scale};
      paint(image + row * ROW + 1 + 3 * column, looks[shape->look].colour, coverage(shape, point));
    }
}

/* --- The file ------------------------------------------------------------------------------------------------------ */

static void append(unsigned char *file, size_t *length, const void *bytes, size_t count) {
  if (count > 0) memcpy(file + *length, bytes, count);
  *length += count;
}

static void append_number(unsigned char *file, size_t *length, uint32_t number) {
  const unsigned char bytes[] = {(unsigned char)(number >> 24), (unsigned char)(number >> 16),
                                 (unsigned char)(number >> 8), (unsigned char)number};
  append(file, length, bytes, sizeof bytes);
}

static uint32_t crc32_of(const unsigned char *bytes, size_t count) {
  uint32_t remainder = 0xffffffffu;
  for (size_t i = 0; i < count; i++) {
    remainder ^= bytes[i];
    for (int bit = 0; bit < 8; bit++) remainder = (remainder >> 1) ^ (remainder & 1 ? 0xedb88320u : 0u);
  }
  return ~remainder;
}

static uint32_t adler32_of(const unsigned char *bytes, size_t count) {
  uint32_t low = 1, high = 0;
  for (size_t i = 0; i < count; i++) {
    low = (low + bytes[i]) % 65521;
    high = (high + low) % 65521;
  }
  return high << 16 | low;
}

static void append_chunk(unsigned char *file, size_t *length, const char *type, const unsigned char *bytes,
                         size_t count) {
  append_number(file, length, (uint32_t)count);
  size_t start = *length;
  append(file, length, type, 4);
  append(file, length, bytes, count);
  append_number(file, length, crc32_of(file + start, *length - start));
}

/* Stores the image as one uncompressed block in zlib format. Returns the length. */
static size_t store(const unsigned char *image, unsigned char *stored) {
  const unsigned char head[] = {0x78, 0x01, 0x01, IMAGE & 0xff, IMAGE >> 8, ~IMAGE & 0xff, ~IMAGE >> 8 & 0xff};
  size_t length = 0;
  append(stored, &length, head, sizeof head);
  append(stored, &length, image, IMAGE);
  append_number(stored, &length, adler32_of(image, IMAGE));
  return length;
}

unsigned char *png_of(const struct Drawing *drawing, size_t *length) {
  static const unsigned char signature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  /* 8 bits each of red, green and blue */
  static const unsigned char header[] = {0, 0, 0, SIDE, 0, 0, 0, SIDE, 8, 2, 0, 0, 0};
  unsigned char *image = allocate(IMAGE, 1), *stored = allocate(IMAGE + 32, 1), *file = allocate(IMAGE + 128, 1);
  memset(image, 0xff, IMAGE);
  for (int row = 0; row < SIDE; row++) image[row * ROW] = 0;
  for (size_t i = 0; i < drawing->count; i++) paint_shape(image, &drawing->shapes[i]);
  *length = 0;
  append(file, length, signature, sizeof signature);
  append_chunk(file, length, "IHDR", header, sizeof header);
  append_chunk(file, length, "IDAT", stored, store(image, stored));
  append_chunk(file, length, "IEND", NULL, 0);
  release(image);
  release(stored);
  return file;
}
