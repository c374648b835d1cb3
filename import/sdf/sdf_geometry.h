// The sizes and surfaces of SDF's shapes, for what is seen and for what collides.
#pragma once

#include <glm/glm.hpp>

#include "import/model/model_description.h"
#include "import/sdf/sdf_element.h"
#include "import/sdf/sdf_reader.h"
#include "scenegraph/height_map.h"

namespace simvis {

/// The number or numbers of a child such as <radius>, in m. Throws InputError at the shape for one that is not above 0.
double sdf_size(const SdfElement& shape, const char* tag, double fallback);
glm::dvec2 sdf_sizes(const SdfElement& shape, const char* tag, const glm::dvec2& fallback);
glm::dvec3 sdf_sizes(const SdfElement& shape, const char* tag, const glm::dvec3& fallback);

/// A rotation that turns +z into the <normal> of a plane. Throws InputError at the plane for one without length.
glm::dmat4 sdf_plane_turn(const SdfElement& plane);

/// Sets the kind, size and surface of a box, sphere, cylinder, capsule, cone, ellipsoid or polyline. False: it is
/// another shape. Throws InputError for wrong sizes.
bool read_sdf_solid(const SdfElement& shape, ModelShape& read);

/// Moves `read` to the <pos> of a <heightmap>, and makes it the map's surface. Throws as sdf_height_map().
void read_sdf_height_map(const SdfElement& map, SdfFiles& files, ModelShape& read);

/// The file of a <mesh> and its scale. Throws InputError for a file that is missing, and a scale of 0 or without a
/// limit.
void read_sdf_mesh(const SdfElement& mesh, SdfFiles& files, ModelShape& read);

/// The surface of a <heightmap>, in a frame that stands at its <pos>. Throws InputError for a picture that is missing
/// or broken, and for wrong sizes.
HeightMap sdf_height_map(const SdfElement& map, SdfFiles& files);
/// The <size> of a heightmap.
inline glm::dvec3 sdf_height_map_size(const SdfElement& map) { return sdf_sizes(map, "size", glm::dvec3(1)); }

}  // namespace simvis
