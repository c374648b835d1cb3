// Committed errors of each hard case: the largest relative error by method, and the number of beams that hit instead of
// missing or miss instead of hitting. hard_case.cpp compares every run with them. After an intended change, copy the
// figures from the table that the program prints.
#pragma once

#include <cstddef>
#include <string_view>

namespace simvis {

struct CommittedError {
  double error_rel = 0;
  std::size_t wrong_kind = 0;
};

struct CommittedErrors {
  std::string_view name;  ///< of the case; that of measure_raster() has ": 512 px" behind it
  CommittedError nearest, planar, hybrid{}, raycast{};
};

inline constexpr CommittedErrors kCommittedErrors[] = {
    {"triangles without area, before a wall and within it", {1}, {1}, {5.8e-8}, {5.8e-8}},
    {"a wall with slivers of 10 m x 10 um in its middle", {0.00012}, {6.5e-8}, {6.5e-8}, {5.1e-8}},
    {"the same by rings", {0.00061}, {6.7e-8}, {6.7e-8}, {5.8e-8}},
    {"a wall that is a fan of slivers of 10 m x 10 um", {0.00061}, {6.7e-8}, {6.7e-8}, {5.8e-8}},
    {"a face", {1}, {1}, {5.8e-8}, {5.8e-8}},
    {"the same face twice, and twice within a mesh", {1}, {1}, {5.8e-8}, {5.8e-8}},
    {"the same face, once cut along the other diagonal", {1}, {1}, {5.8e-8}, {5.8e-8}},
    {"each triangle with vertices of its own, others that none uses", {1}, {1}, {5.8e-8}, {5.8e-8}},
    {"a box of 10^6 m, scaled by 10^-6", {1.2}, {1.2}, {5.8e-8}, {5.8e-8}},
    {"a box of 1 um, scaled by 10^6", {1.2}, {1.2}, {5.8e-8}, {5.8e-8}},
    {"a box scaled by (10^6, 1, 10^-6)", {1.2}, {0.48}, {5.8e-8}, {5.8e-8}},
    {"a box mirrored in one axis", {1.2}, {1.2}, {5.8e-8}, {5.8e-8}},
    {"a box mirrored in three axes", {1.2}, {1.2}, {5.8e-8}, {5.8e-8}},
    {"a box flattened to a plane across the beams", {0.5}, {0.5}, {5.8e-8}, {5.8e-8}},
    {"a box flattened to a plane along the beams", {0.025}, {0.0017}, {5.8e-8}, {5.8e-8}},
    {"a box scaled to a line", {0.00061}, {6.7e-8}, {5.8e-8}, {5.8e-8}},
    {"a box scaled to a point", {0.00061}, {6.7e-8}, {5.8e-8}, {5.8e-8}},
    {"a plane through the sensor, seen from its edge", {0.00061}, {6.7e-8}, {5.8e-8}, {5.8e-8}},
    {"an empty scene", {}, {}, {}, {}},
    {"a scene of an empty mesh and one of a single point", {}, {}, {}, {}},
    {"a single beam", {2.4e-5}, {9.7e-8}, {1.8e-8}, {1.8e-8}},
    {"a single beam of a single ring that is not level", {3.3e-5}, {8.9e-8}, {1e-8}, {1e-8}},
    {"five beams and three rings in one direction", {3.7e-5}, {8.9e-8}, {1e-8}, {1e-8}},
    {"five beams in one direction", {9.7e-8}, {9.7e-8}, {1.8e-8}, {1.8e-8}},
    {"straight up: all beams of a ring in one direction", {}, {}, {}, {}},
    {"beams beside a silhouette, 4 m and 11 m away", {1.6}, {1.6}, {1.4e-7}, {5.9e-8}},
    {"beams beside a silhouette before nothing", {2.2e-5, 180}, {8e-8, 180}, {8e-8}, {5.9e-8}},
    {"wall 0.1 mm before and beyond range_min and range_max", {1e-5, 128}, {7.3e-8, 4}, {7.3e-8}, {4.8e-8}},
    {"beams on shared edges and a shared vertex of a flat wall", {0.00037}, {1.9e-7}, {1.9e-7}, {6e-8}},
    {"beams along and across creases, convex and concave, and corners", {0.0013}, {0.0012}, {6e-8}, {6e-8}},
    {"a T-junction, its corner no vertex of the long edge", {2.1}, {2.1}, {6e-8}, {6e-8}},
    {"the same tessellated with a shared vertex", {0.0012}, {5e-7}, {6e-8}, {6e-8}},
    {"slit of 1 micrometre at a T-junction, 4 m away", {0.66}, {0.66}, {3.9e-8}, {3.9e-8}},
    {"pole 1 mm thin (a quarter of a pixel), 8 m away", {0.63}, {0.63}, {0.63}, {3.7e-8}},
    {"pole 16 mm wide (four pixels), 8 m away", {0.63}, {0.63}, {1.5e-7}, {5.5e-8}},
    {"pole 16 mm wide (four pixels), 8 m away: 512 px", {0.63}, {0.63}},
    {"a room, 0 m from the world's origin", {0.0037}, {0.0025}, {1e-6}, {5.8e-8}},
    {"a room, 1000 m from the world's origin", {0.0037}, {0.0025}, {1e-6}, {5.8e-8}},
    {"a room, 10000 m from the world's origin", {0.0037}, {0.0025}, {1e-6}, {5.8e-8}},
    {"a room, 100000 m from the world's origin", {0.0037}, {0.0025}, {1e-6}, {5.8e-8}},
    {"a room, 1000000 m from the world's origin", {0.0037}, {0.0025}, {1e-6}, {5.8e-8}},
    {"a room, 10000000 m from the world's origin", {0.0037}, {0.0025}, {1e-6}, {5.8e-8}},
    {"walls 0.01 m and 10 km away", {1}, {1}, {3e-7}, {5.7e-8}},
    {"the same by one level ring", {0.00081}, {4.5e-7}, {1.5e-7}, {5.7e-8}},
    {"a box 0.03 m before the sensor, range_min 0.05 m", {0.0016}, {8.8e-7}, {6.7e-7}, {5.7e-8}},
    {"within a box of 0.04 m", {}, {}, {}, {}},
    {"within a box of 0.2 m", {0.0016}, {0.00052}, {5.8e-8}, {5.8e-8}},
    {"a wall 0.2 mm from the sensor", {0.00096}, {4.6e-7}, {3.9e-7}, {5.7e-8}},
    {"on the side of a box of 1 m", {7}, {7}, {3.9e-7}, {5.7e-8}},
    {"on the corner of a box of 1 m", {0.0016}, {0.0012}, {1.2e-6}, {5.9e-8}},
    {"floor 0.1 m below, 0.5 to 100 m away, 64 rings", {0.49}, {1.6e-6}, {5.8e-8}, {5.8e-8}},
    {"floor 0.1 m below, 0.5 to 100 m away, 64 rings: 512 px", {0.22, 31}, {5e-6, 31}},
    {"floor 0.1 m below, 0.1 to 100 m away, upright ring", {0.046}, {2.7e-5}, {5.8e-8}, {5.8e-8}},
    {"floor 0.1 m below, 0.1 to 100 m away, upright ring: 512 px", {0.14, 1}, {1.9e-5}},
    {"floor 0.1 m below, 5 to 100 m away, ring pitched by 1.15 degrees", {0.002}, {1.6e-6}, {5.6e-8}, {5.6e-8}},
    {"floor 0.1 m below, 5 to 100 m away, ring pitched by 1.15 degrees: 512 px", {0.021}, {0.02}},
    {"wall 1 m to the side, 1 to 30 m away", {0.0026}, {2.7e-6}, {5.9e-8}, {5.9e-8}},
    {"wall 1 m to the side, 1 to 30 m away: 512 px", {0.025}, {1.2e-6}},
    {"wall 1 m to the side, 1 to 30 m away, 16 rings", {0.0063}, {7.4e-6}, {5.8e-8}, {5.8e-8}},
    {"wall 1 m to the side, 1 to 30 m away, 16 rings: 512 px", {0.025}, {1.5e-6}},
    {"corridor 2 m wide, 60 m long", {0.0067}, {3.6e-6}, {1.2e-7}, {5.8e-8}},
    {"corridor 2 m wide, 60 m long: 512 px", {0.069}, {2.3e-6}},
    {"incidence around 89.9 degrees, 9 m away", {0.19}, {3e-7}, {5.9e-8}, {5.9e-8}},
    {"incidence around 89.9 degrees, 9 m away: 512 px", {0.22}, {0.065}},
    {"incidence around 89.99 degrees, 11 m away", {0.22}, {1.5e-7}, {5.2e-8}, {5.2e-8}},
    {"incidence around 89.99 degrees, 11 m away: 512 px", {0.22}, {6e-6}},
    {"incidence around 89.999 degrees, 14 m away", {0.22}, {5.9e-6}, {5.8e-8}, {5.8e-8}},
    {"incidence around 89.999 degrees, 14 m away: 512 px", {0.22}, {7.4e-5}},
    {"tilted and rolled ring over flat ground", {0.00091}, {1.6e-6}, {5.6e-8}, {5.6e-8}},
    {"tilted and rolled lidar over flat ground", {0.036, 3}, {6.1e-6}, {5.7e-8}, {5.7e-8}},
    {"beams on borders of faces and 1 ulp beside them, one ring", {0.00043}, {4.4e-7}, {3.5e-7}, {5.2e-8}},
    {"creases and silhouettes on a border of faces", {0.00046}, {0.00025}, {2.7e-7}, {5.9e-8}},
    {"full turns: first and last beam", {0.0022}, {0.0016}, {5.8e-7}, {5.9e-8}},
    {"the same beam from 20 scanners of 64 to 4096 pixels", {0.045}, {0.045}, {1.2e-6}, {5.9e-8}},
    {"borders of a lidar's faces, cube corners, straight up and down", {0.0028}, {0.00097}, {7.6e-7}, {5.8e-8}},
    {"a scanner turned by 10^9 degrees", {0.0033}, {0.0016}, {1.2e-6}, {5.9e-8}},
    {"a scanner with its nose straight down", {0.0031}, {0.00082}, {4.7e-7}, {5.9e-8}},
    {"a scanner with its nose straight up", {0.0031}, {0.00082}, {5.4e-7}, {5.9e-8}},
    {"in the middle of a box", {0.0011}, {1.1e-6}, {1.1e-6}, {5.7e-8}},
    {"in a box, elsewhere", {0.0018}, {0.0016}, {8.7e-7}, {5.6e-8}},
    {"in a room cut into a grid, on the planes of its lines", {0.0017}, {0.0014}, {5.8e-7}, {5.9e-8}},
    {"in a room cut irregularly", {0.0028}, {2.5e-6}, {2.2e-6}, {5.4e-8}},
    {"in the middle of a sphere of 256 triangles", {0.0002}, {0.0001}, {4.5e-7}, {1e-7}},
    {"in a sphere of 256 triangles, elsewhere", {0.00035}, {0.00064}, {6.2e-7}, {1.3e-7}},
};

}  // namespace simvis
