#include "elements/visualization/graph.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <simvis/pose.h>
#include "engine/base/words.h"

namespace simvis {
namespace {

const AttributeRows<GraphLook> kGraphRows{
    AttributeSpec{.name = "nodes",
                  .kind = AttributeKind::text,
                  .unit = "m",
                  .text = "required: positions of the nodes, \"x y z, x y z, ...\""},
    AttributeSpec{.name = "edges",
                  .kind = AttributeKind::text,
                  .text = "pairs of nodes, \"0-1, 1-2, ...\"; the first node is 0; default: no edges"},
    row(&GraphLook::size_m, "size", "m", kMarkerSize_m, "size of a node; 0: not drawn").live(),
    row(&GraphLook::width_m, "width", "m", kMarkerSize_m, "thickness of an edge; 0: not drawn").live(),
    color_rows(&GraphLook::node_color, "", kMarkerColor, " of the nodes"),
    color_rows(&GraphLook::edge_color, "edge_", kMarkerColor, " of the edges")};
constexpr std::size_t kFirstCoordinate = 8;  // index among the live rows

const ElementRegistration kGraphRegistration({
    .name = "graph",
    .summary = "Nodes and edges of a map, in the frame of its insertion point.",
    .notes = "Only cameras with view=\"visualization\" show it; simulated sensors never see it.\nEach coordinate of a "
             "node is a live parameter: x0, y0, z0, x1 and so on.",
    .attributes = kGraphRows.table(),
    .create = create_element<GraphElement>,
});

[[noreturn]] void refuse(const CommandAttribute& attribute, std::size_t entry, std::string_view seen,
                         const std::string& expected) {
  fail_at(attribute.where, "attribute " + in_quotes(attribute.name) + ", entry " + std::to_string(entry) + ": " +
                               in_quotes(seen) + " is not allowed, expected " + expected);
}

}  // namespace

GraphElement::GraphElement(const ElementContext& context)
    : name_(context.command.require("name").value), nodes_(make_marker_nodes(name_)) {
  read_nodes(context.command.require("nodes"));
  if (const CommandAttribute* edges = context.command.find("edges")) read_edges(*edges);
  context.scene.insert(context.command, nodes_.separator);
}

void GraphElement::read_nodes(const CommandAttribute& attribute) {
  std::size_t index = 0;
  for (const std::string_view entry : cells_of(attribute.value)) {
    double place[3];
    const auto too_far = [](double value) { return !(std::abs(value) <= kMaxCoordinate_m); };
    if (!parse_numbers(entry, place) || std::ranges::any_of(place, too_far)) {
      refuse(attribute, index, entry, "\"x y z\", three numbers of at most 1e15 either way (m)");
    }
    const std::string number = std::to_string(index++);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      coordinates_.push_back({std::string(1, "xyz"[axis]) + number, format_number(place[axis]),
                              std::string(1, "xyz"[axis]) + " of node " + number});
    }
  }
}

void GraphElement::read_edges(const CommandAttribute& attribute) {
  const std::size_t nodes = coordinates_.size() / 3;
  for (const std::string_view entry : cells_of(attribute.value)) {
    const std::vector<std::string_view> ends = cells_of(entry, '-');
    const std::optional<std::size_t> from = as_number<std::size_t>(ends.front()),
                                     to = as_number<std::size_t>(ends.back());
    if (ends.size() != 2 || !from || !to || *from >= nodes || *to >= nodes || from == to) {
      refuse(attribute, edges_.size(), entry,
             "\"A-B\", the numbers of two different nodes" +
                 (nodes > 1 ? " from 0 to " + std::to_string(nodes - 1) : ", but there is only one node"));
    }
    edges_.push_back({*from, *to});
  }
}

void GraphElement::adapt_parameters(std::vector<AttributeSpec>& live_rows) const {
  for (const Coordinate& each : coordinates_) {
    live_rows.push_back({.name = each.name,
                         .kind = AttributeKind::number,
                         .default_value = each.default_value,
                         .unit = "m",
                         .text = each.text,
                         .min = -kMaxCoordinate_m,
                         .max = kMaxCoordinate_m,
                         .live = true});
  }
}

void GraphElement::update(ParameterView values) {
  const auto place = [&](std::size_t node) {
    const double* at = &values[kFirstCoordinate + 3 * node];
    return glm::dvec3(at[0], at[1], at[2]);
  };
  GraphLook look;
  kGraphRows.set(look, values);
  const glm::vec4 node_color(look.node_color, 1), edge_color(look.edge_color, 1);
  const glm::dvec3 origin = place(0);  // maps may lie far from the origin
  MarkerMesh markers;
  for (const Edge& edge : edges_) {
    markers.add_line(place(edge.from) - origin, place(edge.to) - origin, look.width_m, edge_color);
  }
  for (std::size_t node = 0; node < coordinates_.size() / 3; ++node) {
    markers.add_point(place(node) - origin, look.size_m, node_color);
  }
  glm::dmat4 frame_from_mesh{1.0};
  frame_from_mesh[3] = {origin, 1};
  nodes_.place->set_matrix(frame_from_mesh);
  nodes_.shape->set_mesh(markers.take(name_));
}

}  // namespace simvis
