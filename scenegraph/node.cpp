#include <simvis/node.h>

#include <algorithm>
#include <iterator>
#include <new>

#include "engine/base/assert.h"

namespace simvis {

void Node::attach(NodeObserver& observer) { observers_.push_back(&observer); }

void Node::detach(NodeObserver& observer) { std::erase(observers_, &observer); }

void Node::tell_content_changed() {
  for (NodeObserver* observer : observers_) observer->content_changed(*this);
}

void Node::tell_structure_changed() {
  for (NodeObserver* observer : observers_) observer->structure_changed();
}

Group::~Group() {
  std::vector<NodePtr> doomed = std::move(children_);
  while (!doomed.empty()) {
    const NodePtr node = std::move(doomed.back());
    doomed.pop_back();
    if (node.use_count() > 1) continue;
    if (const auto group = dynamic_cast<Group*>(node.get())) {
      try {
        const std::size_t needed = doomed.size() + group->children_.size();
        if (needed > doomed.capacity())
          doomed.reserve(2 * needed);  // more than needed, or a deep chain copies all each time
      } catch (const std::bad_alloc&) {
        continue;  // the group ends by itself, within this function
      }
      std::ranges::move(group->children_, std::back_inserter(doomed));
      group->children_.clear();
    }
  }
}

void Group::add(NodePtr child) {
  SIMVIS_ASSERT(child != nullptr);
  children_.push_back(std::move(child));
  tell_structure_changed();
}

void Group::insert_before(const Node& where, NodePtr child) {
  SIMVIS_ASSERT(child != nullptr);
  const auto place = std::ranges::find(children_, &where, &NodePtr::get);
  SIMVIS_ASSERT(place != children_.end());
  children_.insert(place, std::move(child));
  tell_structure_changed();
}

void Group::remove(const Node& child) {
  const auto place = std::ranges::find(children_, &child, &NodePtr::get);
  SIMVIS_ASSERT(place != children_.end());
  children_.erase(place);
  tell_structure_changed();
}

void Switch::set_which(int which) {
  SIMVIS_ASSERT(which >= kNone && which < static_cast<int>(children().size()));
  if (which == which_) return;
  which_ = which;
  tell_structure_changed();
}

void Transform::set_matrix(const glm::dmat4& matrix) {
  if (matrix == matrix_) return;
  matrix_ = matrix;
  tell_content_changed();
}

void MaterialNode::set_material(std::shared_ptr<const Material> material) {
  SIMVIS_ASSERT(material != nullptr);
  if (material == material_) return;
  const bool had_own_slot = has_own_slot();
  material_ = std::move(material);
  has_own_slot_ = true;
  show();
  if (had_own_slot) {
    tell_content_changed();
  } else {
    tell_structure_changed();
  }
}

void MaterialNode::complete_material(std::shared_ptr<const Material> material) {
  SIMVIS_ASSERT(material != nullptr);
  material_ = std::move(material);
  show();
  tell_structure_changed();
}

std::size_t MaterialNode::add_change() {
  restore_change(next_change_);
  return next_change_++;
}

void MaterialNode::restore_change(std::size_t number) {
  changes_.emplace(number, MaterialChange{});
  if (changes_.size() == 1 && !has_own_slot_) tell_structure_changed();
}

void MaterialNode::remove_change(std::size_t number) {
  SIMVIS_ASSERT(changes_.contains(number));
  changes_.erase(number);
  show();
  if (has_own_slot()) {
    tell_content_changed();
  } else {
    tell_structure_changed();
  }
}

void MaterialNode::set_change(std::size_t number, const MaterialChange& change) {
  SIMVIS_ASSERT(changes_.contains(number));
  MaterialChange& known = changes_.at(number);
  if (change == known) return;
  known = change;
  show();
  tell_content_changed();
}

// Applies the changes in double precision, in the order of their numbers, and rounds once.
void MaterialNode::show() {
  if (changes_.empty()) {
    shown_ = material_;
    return;
  }
  glm::dvec3 color(1), emission(material_->emissive);
  double opacity = material_->opacity, roughness = material_->roughness;
  double mirror = material_->mirror, transmission = material_->transmission, index = material_->refractive_index;
  auto shown = std::make_shared<Material>(*material_);
  for (const auto& [number, change] : changes_) {
    if (!change.fixed_opacity) continue;
    opacity = *change.fixed_opacity;
    shown->base_color.a = 1;
    if (shown->alpha_mode == AlphaMode::blend) shown->alpha_mode = AlphaMode::opaque;
  }
  for (const auto& [number, change] : changes_) {
    color *= glm::dvec3(change.color);
    emission += glm::dvec3(change.emission);
    opacity *= change.opacity;
    roughness *= change.roughness;
    mirror += (1 - mirror) * change.mirror;
    transmission += (1 - transmission) * change.transmission;
    index *= change.refractive_index;
  }
  shown->base_color = glm::vec4(glm::dvec4(glm::dvec3(material_->base_color) * color, shown->base_color.a));
  shown->emissive = glm::vec3(emission);
  shown->opacity = static_cast<float>(opacity);
  shown->roughness = static_cast<float>(roughness);
  for (const auto& [number, change] : changes_) {
    if (change.reflectance) shown->reflectance = change.reflectance;
    if (change.retro_reflectance) shown->retro_reflectance = *change.retro_reflectance;
  }
  shown->mirror = static_cast<float>(mirror);
  shown->transmission = static_cast<float>(transmission);
  shown->refractive_index = static_cast<float>(index);
  shown_ = std::move(shown);
}

void Visibility::set_visible(bool visible) {
  if (visible == visible_) return;
  visible_ = visible;
  tell_content_changed();
}

void Shape::set_mesh(std::shared_ptr<const Mesh> mesh) {
  SIMVIS_ASSERT(mesh != nullptr);
  if (mesh == mesh_) return;
  mesh_ = std::move(mesh);
  if (has_own_slot_) {
    tell_content_changed();
  } else {
    has_own_slot_ = true;
    tell_structure_changed();
  }
}

void Shape::restore_mesh(std::shared_ptr<const Mesh> mesh) {
  SIMVIS_ASSERT(mesh != nullptr);
  if (!has_own_slot_) return;
  mesh_ = std::move(mesh);
  has_own_slot_ = false;
  tell_structure_changed();
}

void LightNode::set_light(const Light& light) {
  if (light == light_) return;
  light_ = light;
  tell_content_changed();
}

void LightNode::set_tint(const glm::vec3& tint) {
  if (tint == tint_) return;
  tint_ = tint;
  tell_content_changed();
}

Light LightNode::shown() const {
  Light light = light_;
  light.color *= tint_;
  return light;
}

void EnvironmentNode::set_environment(const Environment& environment) {
  if (environment == environment_) return;
  environment_ = environment;
  tell_content_changed();
}

SkyNode::SkyNode(std::shared_ptr<const SkyPicture> picture, const glm::vec3& mean)
    : Node(NodeKind::sky), view_{.picture = std::move(picture), .mean = mean} {}

void SkyNode::set_factor(float factor) {
  if (factor == view_.factor) return;
  view_.factor = factor;
  tell_content_changed();
}

void MediumNode::set_medium(const Medium& medium) {
  if (medium == medium_) return;
  medium_ = medium;
  tell_content_changed();
}

}  // namespace simvis
