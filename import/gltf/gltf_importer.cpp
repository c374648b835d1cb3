// Imports glTF 2.0 parts (.gltf, .glb): builds a scene graph from the checked document.
#include "import/gltf/gltf_importer.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <simvis/part_importer.h>
#include "engine/base/read_fence.h"
#include "import/gltf/gltf_accessors.h"
#include "import/gltf/gltf_animations.h"
#include "import/gltf/gltf_compression.h"
#include "import/gltf/gltf_document.h"
#include "import/gltf/gltf_hierarchy.h"
#include "import/gltf/gltf_materials.h"
#include "import/gltf/gltf_primitive.h"
#include "import/mesh/imported_graph.h"
#include "import/mesh/shape_node.h"

namespace simvis {
namespace {

// A mesh that is read later: the group that it belongs into, and the node of the file that shows it.
struct PostponedMesh {
  GroupPtr group;
  int node;
};

// The nodes of one primitive: the material node, shared by all its users, and the shape.
struct DrawnPrimitive {
  NodePtr material, shape;
};

class GraphBuilder {
 public:
  GraphBuilder(GltfDocument& document, ContentPool& pool)
      : document_(document),
        pool_(pool),
        materials_(document, pool),
        hierarchy_(read_hierarchy(document)),
        motion_(read_motion(document, hierarchy_)) {
    bindings_.transforms.resize(hierarchy_.order.size());
  }

  PartContent build(bool y_up) {
    PartContent content;
    content.root = build_graph(y_up, content.commands);
    check_what_is_not_shown();
    content.animations = bind_animations(document_, hierarchy_, std::move(motion_), std::move(bindings_));
    content.warnings = std::move(document_.warnings);
    return content;
  }

  // The same without the meshes, for which there are empty groups in `postponed`. The buffers may be closed; the file
  // has no animations.
  PartContent build_structure(bool y_up, std::vector<PostponedMesh>& postponed) {
    postponed_ = &postponed;
    PartContent content;
    content.root = build_graph(y_up, content.commands);
    check_lights();
    content.warnings = std::move(document_.warnings);
    return content;
  }

  // What belongs into the groups that build_structure() has left empty.
  std::vector<ShapesOfGroup> read_meshes(const std::vector<PostponedMesh>& postponed) {
    std::vector<ShapesOfGroup> shapes;
    for (const PostponedMesh& each : postponed) {
      const auto group = std::make_shared<Group>();
      root_ = group.get();
      add_mesh(each.node, document_.model.nodes[static_cast<std::size_t>(each.node)], *group);
      shapes.push_back({each.group, group->children()});
    }
    check_what_is_not_shown();
    return shapes;
  }

 private:
  GroupPtr build_graph(bool y_up, std::vector<std::string>& commands) {
    const auto root = std::make_shared<Separator>();
    root->name = document_.file.stem().string();
    root_ = root.get();
    if (y_up) root->add(std::make_shared<Transform>(kZUpFromYUp));
    add_scene(*root, commands);
    return root;
  }

  // Adds the nodes depth first, in the file's order. The explicit stack allows any depth.
  void add_scene(Group& root, std::vector<std::string>& commands) {
    struct Pending {
      int node;
      Group* parent;
    };
    std::vector<Pending> stack;
    for (auto node = hierarchy_.roots.rbegin(); node != hierarchy_.roots.rend(); ++node)
      stack.push_back({*node, &root});
    while (!stack.empty()) {
      const Pending next = stack.back();
      stack.pop_back();
      Group& group = add_node(next.node, *next.parent);
      const tinygltf::Node& source = document_.model.nodes[static_cast<std::size_t>(next.node)];
      collect_commands(source, commands);
      for (auto child = source.children.rbegin(); child != source.children.rend(); ++child) {
        stack.push_back({*child, &group});
      }
    }
  }

  Group& add_node(int index, Group& parent) {
    const tinygltf::Node& source = document_.model.nodes[static_cast<std::size_t>(index)];
    const auto separator = std::make_shared<Separator>();
    separator->name = source.name;
    add_transform(static_cast<std::size_t>(index), *separator);
    add_points(texts_of(source, "simvis_points"), ObjectKind::frame, *separator);
    add_points(texts_of(source, "simvis_models"), ObjectKind::model, *separator);
    add_points(texts_of(source, "simvis_links"), ObjectKind::link, *separator);
    if (source.mesh >= 0) add_mesh(index, source, *separator);
    const auto light = source.extensions.find("KHR_lights_punctual");
    if (light != source.extensions.end()) separator->add(make_light(light->second.Get("light").GetNumberAsInt()));
    if (source.camera >= 0) {
      const auto mount = std::make_shared<Mount>();
      mount->name = source.name;
      separator->add(mount);
    }
    parent.add(separator);
    return *separator;
  }

  static void add_points(const std::vector<std::string>& names, ObjectKind kind, Group& group) {
    for (const std::string& name : names) {
      const auto point = std::make_shared<InsertionPoint>(kind);
      point->name = name;
      group.add(point);
    }
  }

  void add_transform(std::size_t index, Group& group) {
    const glm::dmat4& local = hierarchy_.parent_from_node[index];
    if (local == glm::dmat4(1) && !motion_.is_moved[index]) return;
    const auto transform = std::make_shared<Transform>(local);
    if (motion_.is_moved[index]) bindings_.transforms[index] = transform;
    group.add(transform);
  }

  void add_mesh(int index, const tinygltf::Node& source, Group& group) {
    if (postponed_ != nullptr) {
      postponed_->push_back({std::make_shared<Group>(), index});
      (source.skin >= 0 ? *root_ : group).add(postponed_->back().group);
      return;
    }
    if (source.skin >= 0) {
      // The joints alone place a skinned mesh. The transform of its own node has no effect.
      const auto skinned = std::make_shared<Separator>();
      skinned->name = source.name;
      add_primitives(make_primitives(index), *skinned);
      root_->add(skinned);
      return;
    }
    const std::vector<DrawnPrimitive> primitives = primitives_of(index);
    if (source.extensions.count("EXT_mesh_gpu_instancing") == 0) return add_primitives(primitives, group);
    for (const glm::dmat4& node_from_instance : read_instances(document_, index)) {
      const auto instance = std::make_shared<Separator>();
      instance->add(std::make_shared<Transform>(node_from_instance));
      add_primitives(primitives, *instance);
      group.add(instance);
    }
  }

  static void add_primitives(const std::vector<DrawnPrimitive>& primitives, Group& group) {
    for (const DrawnPrimitive& primitive : primitives) {
      group.add(primitive.material);
      group.add(primitive.shape);
    }
  }

  // Returns the shapes of a node's mesh. Nodes with the same mesh share them, except nodes with their own morph
  // weights.
  std::vector<DrawnPrimitive> primitives_of(int node) {
    const tinygltf::Node& source = document_.model.nodes[static_cast<std::size_t>(node)];
    if (!source.weights.empty() || motion_.moving_weights[static_cast<std::size_t>(node)] > 0) {
      return make_primitives(node);
    }
    const auto known = primitives_.find(source.mesh);
    if (known != primitives_.end()) return known->second;
    return primitives_.emplace(source.mesh, make_primitives(node)).first->second;
  }

  std::vector<DrawnPrimitive> make_primitives(int node) {
    const int mesh_index = document_.model.nodes[static_cast<std::size_t>(node)].mesh;
    const tinygltf::Mesh& source = document_.model.meshes[static_cast<std::size_t>(mesh_index)];
    shown_meshes_.insert(mesh_index);
    std::vector<DrawnPrimitive> drawn;
    for (const tinygltf::Primitive& primitive_source : source.primitives) {
      GltfPrimitive primitive;
      if (!read_primitive(document_, primitive_source, primitive)) continue;
      const bool shaded =
          primitive.mesh.splats == nullptr && (primitive.mesh.topology == Topology::triangles || primitive.has_normals);
      const auto shape = make_shape(node, primitive_source, std::move(primitive), source.name);
      drawn.push_back({materials_.get(primitive_source.material, shaded), shape});
    }
    return drawn;
  }

  NodePtr make_shape(int node, const tinygltf::Primitive& source, GltfPrimitive&& primitive, const std::string& name) {
    const int skin = document_.model.nodes[static_cast<std::size_t>(node)].skin;
    primitive.mesh.name = name;
    if (primitive.mesh.splats != nullptr) return shape_node(std::move(primitive.mesh), pool_);
    if (source.targets.empty() && skin < 0) {
      complete_mesh(primitive.mesh, primitive.needs_flat_normals());
      return shape_node(std::move(primitive.mesh), pool_);
    }
    // The shape shows the rest pose. If an animation deforms it, the data for the deformation is kept.
    const bool weights_change = motion_.moving_weights[static_cast<std::size_t>(node)] > 0;
    const bool joints_move = skin >= 0 && moves_skin(document_, motion_, skin);
    if (!source.targets.empty() && !weights_change) {
      document_.warn("morph targets are not animated; meshes are imported with their default weights");
    }
    if (skin >= 0 && !joints_move) {
      document_.warn("skins are not animated; skinned meshes are imported in their rest pose");
    }
    std::vector<glm::dmat4> joints;
    if (skin >= 0) joints = read_joint_matrices(document_, hierarchy_, skin);
    std::vector<double> weights = rest_weights(document_, node);
    auto mesh = std::make_shared<const DeformableMesh>(
        read_deformable(document_, source, std::move(primitive), weights, weights_change,
                        skin >= 0 ? static_cast<int>(joints.size()) : -1));
    if (mesh->targets.empty()) weights.clear();
    std::optional<Mesh> at_rest = deform(*mesh, weights, joints);
    if (!at_rest) document_.fail("has a vertex that its morph targets or joints move to where float32 is not finite");
    const std::shared_ptr<Shape> shape = shape_node(std::move(*at_rest), pool_);
    if (weights_change || joints_move) {
      bindings_.shapes.push_back({shape, std::move(mesh), weights_change ? node : -1, skin, std::move(weights)});
    }
    return shape;
  }

  // Checks the parts of the file that the scene does not show, because a broken file is always refused.
  void check_what_is_not_shown() {
    check_lights();
    for (std::size_t i = 0; i < document_.model.skins.size(); ++i) {
      read_joint_matrices(document_, hierarchy_, static_cast<int>(i));
    }
    for (std::size_t i = 0; i < document_.model.meshes.size(); ++i) {
      if (shown_meshes_.count(static_cast<int>(i)) != 0) continue;
      for (const tinygltf::Primitive& source : document_.model.meshes[i].primitives) {
        GltfPrimitive primitive;
        read_primitive(document_, source, primitive);
      }
    }
  }

  void check_lights() const {
    for (std::size_t i = 0; i < document_.model.lights.size(); ++i) make_light(static_cast<int>(i));
  }

  NodePtr make_light(int index) const {
    const std::string place = "lights/" + std::to_string(index);
    const tinygltf::Light& source = document_.model.lights[static_cast<std::size_t>(index)];
    Light light;
    if (source.type == "point") {
      light.kind = LightKind::point;
    } else if (source.type == "spot") {
      light.kind = LightKind::spot;
    } else if (source.type != "directional") {
      document_.fail(place + "/type is \"" + source.type + "\"; expected directional, point or spot");
    }
    if (!source.color.empty()) light.color = glm::vec3(source.color[0], source.color[1], source.color[2]);
    light.intensity = source.intensity;
    light.range_m = source.range;
    light.direction = {0, 0, -1};
    if (light.kind == LightKind::spot) {
      light.inner_cone_rad = source.spot.innerConeAngle;
      light.outer_cone_rad = source.spot.outerConeAngle;
      if (light.inner_cone_rad >= light.outer_cone_rad) {
        document_.fail(place + "/spot has an innerConeAngle that is not below its outerConeAngle");
      }
    }
    const auto node = std::make_shared<LightNode>(light);
    node->name = source.name;
    return node;
  }

  static void collect_commands(const tinygltf::Node& source, std::vector<std::string>& commands) {
    for (std::string& command : texts_of(source, "simvis")) commands.push_back(std::move(command));
  }

  // The texts of a member of `extras`, which the schema has checked.
  static std::vector<std::string> texts_of(const tinygltf::Node& source, const char* member) {
    std::vector<std::string> found;
    if (!source.extras.IsObject() || !source.extras.Has(member)) return found;
    const tinygltf::Value& texts = source.extras.Get(member);
    for (std::size_t i = 0; i < texts.ArrayLen(); ++i) {
      found.push_back(texts.Get(static_cast<int>(i)).Get<std::string>());
    }
    return found;
  }

  GltfDocument& document_;
  ContentPool& pool_;
  GltfMaterials materials_;
  GltfHierarchy hierarchy_;
  GltfMotion motion_;
  GltfBindings bindings_;
  Group* root_ = nullptr;
  std::map<int, std::vector<DrawnPrimitive>> primitives_;
  std::set<int> shown_meshes_;
  std::vector<PostponedMesh>* postponed_ = nullptr;  // null: meshes are read at once
};

// Decodes and checks what the buffers hold.
void decode(GltfDocument& document) {
  decode_compressed_geometry(document);
  check_accessors(document);
}

// Reads the file once more. Its structure must be the same.
ShapeReader reader_of(const GltfDocument& structure, std::vector<PostponedMesh> postponed) {
  return [file = structure.file, hash = structure.structure_hash, postponed = std::move(postponed)](
             ContentPool& pool, std::vector<std::string>& warnings) {
    const PartFence fence(file);
    GltfDocument document = read_gltf_document(file);
    if (document.structure_hash != hash) document.fail("has changed since the scene was read");
    decode(document);
    std::vector<ShapesOfGroup> shapes = GraphBuilder(document, pool).read_meshes(postponed);
    std::ranges::move(document.warnings, std::back_inserter(warnings));
    return shapes;
  };
}

PartContent import_structure(GltfDocument& document, ContentPool& pool, bool y_up) {
  std::vector<PostponedMesh> postponed;
  PartContent content = GraphBuilder(document, pool).build_structure(y_up, postponed);
  content.read_shapes = reader_of(document, std::move(postponed));
  return content;
}

PartContent import_gltf(const ImportRequest& request, ContentPool& pool) {
  const PartFence fence(request.file);
  const bool y_up = !request.up_given || request.up == UpAxis::y;
  if (request.postpone_shapes) {
    GltfDocument structure = read_gltf_document(request.file, false);
    // Animations move what a file has: their times are in its buffers, and they bind to its meshes.
    if (structure.animations.empty()) return import_structure(structure, pool, y_up);
  }
  GltfDocument document = read_gltf_document(request.file);
  return build_gltf(document, pool, y_up);
}

const PartImporterRegistration gltf_registration({".gltf", ".glb"}, import_gltf);

}  // namespace

PartContent build_gltf(GltfDocument& document, ContentPool& pool, bool y_up) {
  decode(document);
  return GraphBuilder(document, pool).build(y_up);
}

std::shared_ptr<const Mesh> gltf_mesh(GltfDocument& document, std::size_t mesh, ContentPool& pool) {
  Mesh whole;
  for (const tinygltf::Primitive& source : document.model.meshes.at(mesh).primitives) {
    GltfPrimitive primitive;
    if (!read_primitive(document, source, primitive) || primitive.mesh.topology != Topology::triangles) continue;
    const auto first = static_cast<std::uint32_t>(whole.positions.size());
    const Mesh& part = primitive.mesh;
    whole.positions.insert(whole.positions.end(), part.positions.begin(), part.positions.end());
    for (const std::uint32_t index : part.indices) whole.indices.push_back(first + index);
  }
  whole.attributes.resize(whole.positions.size());
  compute_bounds(whole);
  return pool.intern(std::move(whole));
}
}  // namespace simvis
