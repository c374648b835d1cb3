// The element `graph`: draws the nodes and edges of a map.
//
//   <element type="graph" name="MAP" insert_at="ROOT" nodes="0 0 0.1, 2 0 0.1, 2 3 0.1" edges="0-1, 1-2"/>
//
// Only cameras with view="visualization" see it.
// Frames   positions are in the frame of the insertion point.
// Parameters  size, width (m), red green blue of the nodes, edge_red edge_green edge_blue (linear), and the position of
//          each node, x0 y0 z0 x1 y1 z1 ... (m); all live.
#pragma once

#include <string>
#include <vector>

#include <simvis/element.h>
#include "elements/visualization/marker_mesh.h"

namespace simvis {

struct GraphLook {
  double size_m = 0.25, width_m = 0.05;  ///< of nodes and of edges
  glm::vec3 node_color{1, 0.35f, 0}, edge_color{0.9f, 0.75f, 0.05f};
};

class GraphElement : public Element {
 public:
  /// Throws InputError at the attribute if a node is not three numbers or an edge does not join two of the nodes.
  explicit GraphElement(const ElementContext& context);
  void update(ParameterView values) override;
  void adapt_parameters(std::vector<AttributeSpec>& live_rows) const override;

 private:
  struct Edge {
    std::size_t from, to;
  };
  // The strings of the attribute row for one coordinate of a node.
  struct Coordinate {
    std::string name, default_value, text;
  };
  void read_nodes(const CommandAttribute& attribute);
  void read_edges(const CommandAttribute& attribute);

  std::string name_;
  MarkerNodes nodes_;
  std::vector<Coordinate> coordinates_;  // x0 y0 z0 x1 ...
  std::vector<Edge> edges_;
};

}  // namespace simvis
