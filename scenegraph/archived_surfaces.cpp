#include "scenegraph/archived_surfaces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include <simvis/node.h>

namespace simvis {
namespace {

// The shapes and the material nodes of a graph, numbered in the order of a walk. A graph that the same commands have
// made has the same numbers, whichever children its switches show. What is drawn for people alone has none: sensors do
// not see it.
class GraphContent {
 public:
  explicit GraphContent(const Group& root) { add(root); }

  /// A number, or the content.
  void archive(StateArchive& state, std::shared_ptr<const Mesh>& mesh) const;
  void archive(StateArchive& state, std::shared_ptr<const Texture>& texture) const;

 private:
  void add(const Group& group);
  std::unordered_set<const Node*> known_;
  std::vector<const Shape*> shapes_;
  std::vector<const MaterialNode*> materials_;
  std::unordered_map<const Mesh*, std::uint32_t> shape_of_;        // of meshes that their shape keeps
  std::unordered_map<const Texture*, std::uint32_t> material_of_;  // of textures of base colours
};

void GraphContent::add(const Group& group) {
  for (const NodePtr& child : group.children()) {
    if (child->kind() == NodeKind::visual || !known_.insert(child.get()).second) continue;
    if (const auto* const below = dynamic_cast<const Group*>(child.get())) {
      add(*below);
    } else if (const auto* const shape = dynamic_cast<const Shape*>(child.get())) {
      if (!shape->has_own_slot()) shape_of_.emplace(shape->mesh().get(), shapes_.size());
      shapes_.push_back(shape);
    } else if (const auto* const material = dynamic_cast<const MaterialNode*>(child.get())) {
      material_of_.emplace(material->material()->base_color_texture.get(), materials_.size());
      materials_.push_back(material);
    }
  }
}

// How an object is written.
enum class Written : std::uint8_t { absent, number, content };

template <typename T>
Written written_as(const std::unordered_map<const T*, std::uint32_t>& numbers, const T* object) {
  if (object == nullptr) return Written::absent;
  return numbers.contains(object) ? Written::number : Written::content;
}

void archive_content(StateArchive& state, ExactSurface& surface) {
  state.choice(surface.kind, SurfaceKind::disc);
  state(surface.axis, surface.radius_m, surface.length_m, surface.deviation_m, surface.half_size_m, surface.drawn_m);
  const bool is_plane = surface.kind == SurfaceKind::plane;
  const auto is_length = [](double value) { return std::isfinite(value) && value >= 0; };
  state.require(surface.axis >= 0 && surface.axis < 3);
  state.require(is_plane || (is_length(surface.radius_m) && is_length(surface.length_m)));
  const bool has_length = surface.kind == SurfaceKind::cylinder || surface.kind == SurfaceKind::cone;
  state.require(!has_length || surface.length_m > 0);
  state.require(is_length(surface.deviation_m) && is_length(surface.drawn_m.x) && is_length(surface.drawn_m.y));
  state.require(surface.half_size_m.x > 0 && surface.half_size_m.y > 0);
}

bool is_finite_vector(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

bool is_finite_vertex(const VertexAttributes& of) {
  return is_finite_vector(of.normal) && is_finite_vector(glm::vec3(of.uv[0], 0)) &&
         is_finite_vector(glm::vec3(of.uv[1], 0)) && is_finite_vector(glm::vec3(of.color)) && std::isfinite(of.color.a);
}

// A mesh without corners, of markers that are not drawn, may have a surface without size. Discs are points that have a
// normal, see point_shapes.cpp.
void require_surface(const StateArchive& state, const Mesh& mesh, const ExactSurface& surface) {
  const bool is_disc = surface.kind == SurfaceKind::disc, is_plane = surface.kind == SurfaceKind::plane;
  state.require(!is_disc || mesh.topology == Topology::points);
  state.require(is_plane || mesh.indices.empty() || surface.radius_m > 0);
  if (!is_disc) return;
  constexpr float kMaxDeviation = 1e-3f;  // of the length of a normal, in files of clouds
  for (const std::uint32_t each : mesh.indices) {
    state.require(std::abs(glm::length(mesh.attributes[each].normal) - 1) <= kMaxDeviation);
  }
}

void archive_content(StateArchive& state, Mesh& mesh) {
  state.choice(mesh.topology, Topology::points);
  state(mesh.positions, mesh.indices, mesh.short_lived);
  std::size_t attributes = mesh.attributes.size();
  state.count(attributes, sizeof(VertexAttributes));
  state.require(attributes == mesh.positions.size());
  mesh.attributes.resize(attributes);
  for (VertexAttributes& each : mesh.attributes) state(each.normal, each.uv[0], each.uv[1], each.color);
  bool is_exact = mesh.surface.has_value();
  state(is_exact);
  if (is_exact && !mesh.surface) mesh.surface.emplace();
  if (is_exact) archive_content(state, *mesh.surface);
  const std::size_t corners = mesh.topology == Topology::triangles ? 3 : mesh.topology == Topology::lines ? 2 : 1;
  state.require(std::ranges::all_of(mesh.positions, is_finite_vector) && mesh.indices.size() % corners == 0);
  state.require(std::ranges::all_of(mesh.indices, [&](std::uint32_t i) { return i < mesh.positions.size(); }));
  state.require(std::ranges::all_of(mesh.attributes, is_finite_vertex));
  if (mesh.surface) require_surface(state, mesh, *mesh.surface);
  if (state.is_reading()) compute_bounds(mesh);
}

void archive_content(StateArchive& state, Texture& texture) {
  state(texture.width, texture.height, texture.rgba);
  const std::size_t row = 4 * std::size_t{texture.width}, size = texture.rgba.size();
  state.require(size > 0 && row > 0 && size % row == 0 && size / row == texture.height);
  Sampler& sampler = texture.sampler;
  for (Wrap* const wrap : {&sampler.wrap_u, &sampler.wrap_v}) state.choice(*wrap, Wrap::clamp_to_edge);
  for (Filter* const filter : {&sampler.magnify, &sampler.minify, &sampler.between_mips}) {
    state.choice(*filter, Filter::linear);
  }
  state(sampler.mipmapped);
}

template <typename T>
void archive_content(StateArchive& state, std::shared_ptr<const T>& object) {
  T content = state.is_reading() ? T{} : *object;
  archive_content(state, content);
  if (state.is_reading()) object = std::make_shared<const T>(std::move(content));
}

void GraphContent::archive(StateArchive& state, std::shared_ptr<const Mesh>& mesh) const {
  Written as = written_as(shape_of_, mesh.get());
  state.choice(as, Written::content);
  state.require(as != Written::absent);
  if (as == Written::content) return archive_content(state, mesh);
  std::uint32_t number = state.is_reading() ? 0 : shape_of_.at(mesh.get());
  state(number);
  if (!state.is_reading()) return;
  state.require(number < shapes_.size() && !shapes_[number]->has_own_slot());
  mesh = shapes_[number]->mesh();
}

void GraphContent::archive(StateArchive& state, std::shared_ptr<const Texture>& texture) const {
  Written as = written_as(material_of_, texture.get());
  state.choice(as, Written::content);
  if (as == Written::content) return archive_content(state, texture);
  if (as == Written::absent) return texture.reset();
  std::uint32_t number = state.is_reading() ? 0 : material_of_.at(texture.get());
  state(number);
  if (!state.is_reading()) return;
  state.require(number < materials_.size());
  texture = materials_[number]->material()->base_color_texture;
  state.require(texture != nullptr);
}

void archive_seen(StateArchive& state, Material& material, const GraphContent& content) {
  state.choice(material.alpha_mode, AlphaMode::blend);
  state(material.alpha_cutoff, material.opacity, material.base_color, material.double_sided, material.uv_set,
        material.uv_transform);
  state.require(std::isfinite(material.alpha_cutoff) && material.opacity >= 0 && material.opacity <= 1);
  state.require(material.uv_set == 0 || material.uv_set == 1);
  content.archive(state, material.base_color_texture);
}

template <typename T, typename ArchiveEach>
void archive_table(StateArchive& state, std::vector<std::shared_ptr<const T>>& all, const ArchiveEach& archive_each) {
  std::size_t count = all.size();
  state.count(count, sizeof(std::uint32_t));
  all.resize(count);
  for (std::shared_ptr<const T>& each : all) archive_each(each);
}

}  // namespace

void archive_surfaces(StateArchive& state, DrawList& list) {
  const GraphContent content(state.graph());
  archive_table(state, list.meshes, [&](std::shared_ptr<const Mesh>& mesh) { content.archive(state, mesh); });
  archive_table(state, list.materials, [&](std::shared_ptr<const Material>& material) {
    Material seen = state.is_reading() ? Material{} : *material;
    archive_seen(state, seen, content);
    if (state.is_reading()) material = std::make_shared<const Material>(std::move(seen));
  });
  std::size_t places = list.world_from_node.size(), items = list.items.size();
  state.count(places, sizeof(glm::dmat4));
  list.world_from_node.resize(places);
  for (glm::dmat4& each : list.world_from_node) state.finite(each);
  constexpr std::size_t kItemSize = 3 * sizeof(std::uint32_t) + 1;
  state.count(items, kItemSize);
  list.items.resize(items);
  for (DrawItem& each : list.items) {
    state(each.mesh, each.material, each.transform, each.visible);
    state.require(each.mesh < list.meshes.size() && each.material < list.materials.size() && each.transform < places);
  }
  if (!state.is_reading()) return;
  list.material_revision.assign(list.materials.size(), 0);
  list.changes.mark_structure_dirty();
}

}  // namespace simvis
