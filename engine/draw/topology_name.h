// Names of topologies, for messages.
#pragma once

#include <string_view>

#include <simvis/mesh.h>

namespace simvis {

inline std::string_view name_of(Topology topology) {
  switch (topology) {
    case Topology::triangles:
      return "triangles";
    case Topology::lines:
      return "lines";
    case Topology::points:
      return "points";
  }
  return "?";
}

}  // namespace simvis
