#include "simvis/sharing/scene_entities.h"

#include <regex.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <glm/gtc/quaternion.hpp>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include <simvis/part_importer.h>
#include <simvis/pose.h>
#include "elements/pose_rows.h"
#include "elements/sensed_physics.h"
#include "engine/base/read_error.h"
#include "exchange/messages/from_pose.h"
#include "scenegraph/graph_walk.h"
#include "simvis/built_scene.h"
#include "simvis/change_log.h"
#include "simvis/mount_frame.h"
#include "simvis/nested_points.h"
#include "simvis/ros/frame_tree.h"

namespace simvis {
namespace {

using Result = ros::SimulationResult;
using Spawn = ros::SpawnResult;
using Attributes = std::vector<std::pair<std::string, std::string>>;

constexpr const char* kRequestName = "request of a service";  // in messages about it
constexpr std::string_view kNameCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";

// A pattern of POSIX. Counts such as {2,9} could need any amount of memory, and \1 any amount of time. glibc compiles
// the operand of each + twice, so n nested ones need 2^n times the memory.
class NamePattern {
 public:
  static constexpr std::size_t kMaxLength = 256;
  static constexpr std::ptrdiff_t kMaxPlus = 6;
  explicit NamePattern(const std::string& text)
      : is_valid_(text.size() <= kMaxLength && text.find_first_of(std::string_view("{\\\0", 3)) == text.npos &&
                  std::ranges::count(text, '+') <= kMaxPlus &&
                  ::regcomp(&compiled_, text.c_str(), REG_EXTENDED | REG_NOSUB) == 0) {}
  ~NamePattern() {
    if (is_valid_) ::regfree(&compiled_);
  }
  NamePattern(const NamePattern&) = delete;
  NamePattern& operator=(const NamePattern&) = delete;

  bool is_valid() const { return is_valid_; }
  bool matches(const std::string& name) const { return ::regexec(&compiled_, name.c_str(), 0, nullptr, 0) == 0; }

 private:
  regex_t compiled_{};
  bool is_valid_;
};

ros::Vector3 to_vector3(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

glm::dmat4 matrix_of_message(const ros::Pose& pose, std::uint8_t code_of_invalid) {
  constexpr double kLengthTolerance = 1e-3;  // of decimals that people write, such as 0.707
  const glm::dvec3 place(pose.position.x, pose.position.y, pose.position.z);
  const glm::dquat turn(pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z);
  const auto is_allowed = [](double number) { return std::abs(number) <= kMaxCoordinate_m; };
  if (!is_allowed(place.x) || !is_allowed(place.y) || !is_allowed(place.z) ||
      !(std::abs(glm::length(turn) - 1) <= kLengthTolerance)) {
    throw ServiceRefusal(code_of_invalid,
                         "the pose is not valid, expected finite numbers, and a quaternion of length 1");
  }
  glm::dmat4 matrix = glm::mat4_cast(glm::normalize(turn));
  matrix[3] = glm::dvec4(place, 1);
  return matrix;
}

// The path that a uri names; empty: none.
std::string path_of_uri(std::string_view uri) {
  constexpr std::string_view kFile = "file://", kDigits = "0123456789abcdef";
  if (!uri.starts_with(kFile)) return uri.find("://") == uri.npos ? std::string(uri) : "";
  uri.remove_prefix(kFile.size());
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const auto digit = [&](std::size_t at) {
      return at < uri.size() ? kDigits.find(static_cast<char>(uri[at] | 0x20)) : kDigits.npos;
    };
    const std::size_t high = digit(i + 1), low = digit(i + 2);
    const bool is_code = uri[i] == '%' && high != kDigits.npos && low != kDigits.npos;
    path += is_code ? static_cast<char>(16 * high + low) : uri[i];
    if (is_code) i += 2;
  }
  return path;
}

// Throws unless a scene file can name it, and a message too.
std::string file_of(const ros::Resource& resource) {
  if (resource.uri.empty()) {
    if (resource.resource_string.empty()) throw ServiceRefusal(Spawn::kNoResource, "there is no uri");
    throw ServiceRefusal(Result::kUnsupported, "resource_string is not read, expected the uri of a file");
  }
  const std::string path = path_of_uri(resource.uri);
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (path.empty() || path.find("${") != path.npos || std::ranges::any_of(path, is_control)) {
    throw ServiceRefusal(Result::kNotFound, in_quotes(resource.uri) + " names no file, expected a path or file://PATH");
  }
  if (find_part_importer(path) != nullptr) return path;
  std::string known;
  for (const std::string& ending : known_part_endings()) known += (known.empty() ? "" : " ") + ending;
  throw ServiceRefusal(Spawn::kUnsupportedFormat, in_quotes(path) + " has no known ending, expected one of " + known);
}

void require_no_namespace(const std::string& name) {
  if (name.empty()) return;
  const bool is_valid = name.find_first_not_of(std::string(kNameCharacters) + "/") == name.npos;
  throw ServiceRefusal(is_valid ? Result::kUnsupported : Spawn::kNamespaceInvalid,
                       "entity_namespace " + in_quotes(name) + ", expected none");
}

std::string to_xml(CommandKind kind, const Attributes& attributes) {
  Command command{.kind = kind, .attributes = {}, .where = {}, .folder = {}};
  for (const auto& [name, value] : attributes) command.attributes.push_back({name, value, {}});
  return to_string(command);
}

}  // namespace

SceneEntities::SceneEntities(Simulation& simulation, std::span<const std::filesystem::path> folders)
    : simulation_(simulation), folders_(folders), start_(standing_commands(simulation.parameters().changes())) {}

const BuiltScene& SceneEntities::scene() { return updated_scene(simulation_); }

void SceneEntities::require(const std::string& entity) {
  const Scene& built = scene().scene;
  if (!built.has_part(entity)) throw ServiceRefusal(Result::kNotFound, built.objects().unknown("entity", entity));
}

std::vector<std::string> SceneEntities::names(const ros::EntityFilters& filters) {
  if (!filters.categories.empty() || !filters.tags.tags.empty() || filters.bounds.type != 0) {
    throw ServiceRefusal(Result::kUnsupported, "expected a filter by names alone, without categories, tags and bounds");
  }
  const NamePattern pattern(filters.filter);
  if (!pattern.is_valid()) {
    throw ServiceRefusal(Result::kFailed,
                         "the filter is not valid, expected an extended regular expression of POSIX without { and \\, "
                         "of at most " +
                             std::to_string(NamePattern::kMaxLength) + " characters and " +
                             std::to_string(NamePattern::kMaxPlus) + " +");
  }
  std::vector<std::string> names;
  for (const Object& object : scene().scene.objects().all()) {
    if (object.kind == ObjectKind::part && pattern.matches(object.name)) names.push_back(object.name);
  }
  return names;
}

// Rigid. Empty: it is switched off, or scaled to nothing.
std::optional<glm::dmat4> SceneEntities::world_from(const std::string& point) {
  const std::optional<glm::dmat4> place = scene().scene.world_from_point(point);
  glm::dmat4 rigid;
  return place && rigid_mount_frame(*place, rigid) ? std::optional(rigid) : std::nullopt;
}

std::optional<ros::EntityState> SceneEntities::state(const std::string& entity) {
  require(entity);
  return states(std::span(&entity, 1)).front();
}

// Walks the graph once for all of them.
std::vector<std::optional<ros::EntityState>> SceneEntities::states(std::span<const std::string> entities) {
  const BuiltScene& built = scene();
  FrameTree frames;
  frames.follow(built);
  const std::optional<FrameTime> last = simulation_.last_frame();
  const auto physics = find_physics(built.scene);
  const std::vector<NestedPoint> points = nested_points(built.scene, entities);
  std::vector<std::optional<ros::EntityState>> states(entities.size());
  for (std::size_t i = 0; i < entities.size(); ++i) {
    glm::dmat4 rigid;
    if (!points[i].world_from_point || !rigid_mount_frame(*points[i].world_from_point, rigid)) continue;
    ros::EntityState& state = states[i].emplace();
    state.header = ros::header_of(last ? last->time_ns : 0, frames.world());
    state.pose = ros::pose_stamped({.time_ns = 0, .world_from_body = rigid}, "").pose;
    if (physics == nullptr || placed_.contains(entities[i])) continue;
    const std::optional<StepMotion::At> motion = physics->state_of(entities[i]);
    if (!motion) continue;
    state.twist.linear = to_vector3(motion->velocity_of(glm::dvec3(rigid[3])));
    state.twist.angular = to_vector3(motion->angular_velocity_rad_s);
  }
  return states;
}

glm::dmat4 SceneEntities::world_from_frame(const std::string& frame) {
  const BuiltScene& built = scene();
  FrameTree frames;
  frames.follow(built);
  if (frame.empty() || frame == frames.world()) return glm::dmat4(1);
  const std::span<const Object> objects = built.scene.objects().all();
  auto found = std::ranges::find_if(objects, [&](const Object& each) { return frames.of_point(each.name) == frame; });
  if (found == objects.end()) found = std::ranges::find(objects, frame, &Object::name);
  if (found == objects.end()) {
    throw ServiceRefusal(Result::kNotFound, "there is no frame " + in_quotes(frame) + ", expected none, " +
                                                in_quotes(frames.world()) + " or the frame of a part or link");
  }
  const std::optional<glm::dmat4> place = world_from(found->name);
  if (!place) throw ServiceRefusal(Result::kFailed, "frame " + in_quotes(frame) + " is switched off");
  return *place;
}

// The last element at the entity that has a pose; what stands behind it moves with it.
std::optional<std::size_t> SceneEntities::find_pose_element(const std::string& entity) {
  const BuiltScene& built = scene();
  const std::vector<ElementDescriptor>& all = built.parameters.elements();
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].removed || all[i].insertion_point != entity) continue;
    const std::vector<AttributeSpec>& rows = all[i].parameters;
    const bool has_pose = rows.size() >= kPoseValues &&
                          std::equal(std::begin(kPoseRows), std::end(kPoseRows), rows.begin(),
                                     [](const AttributeSpec& a, const AttributeSpec& b) { return a.name == b.name; });
    if (has_pose) found = i;
    if (!has_pose && built.elements[i]->moves_itself()) {
      throw ServiceRefusal(Result::kFailed, in_quotes(entity) + " is moved by the element " + in_quotes(all[i].name) +
                                                ", which can't be put elsewhere");
    }
  }
  return found;
}

// An entity that nothing can move gets an element that moves all of it.
std::size_t SceneEntities::pose_element(const std::string& entity) {
  if (const std::optional<std::size_t> found = find_pose_element(entity)) return *found;
  const std::string name = free_element(entity);
  execute(to_xml(CommandKind::element, {{"type", "pose"}, {"name", name}, {"insert_at", entity}, {"moves", "all"}}));
  return find_pose_element(entity).value();
}

// All values of the pose, or none.
void SceneEntities::set_pose(const ElementDescriptor& element, const glm::dmat4& parent_from_child) {
  std::vector<double> values(kPoseValues);
  write_pose(parent_from_child, values);
  for (std::size_t i = 0; i < kPoseValues; ++i) {
    const std::string wrong = check_number(element.parameters[i], values[i]);
    if (wrong.empty()) continue;
    throw ServiceRefusal(Result::kFailed, element.name + "." + std::string(element.parameters[i].name) + ": " + wrong);
  }
  for (std::size_t i = 0; i < kPoseValues; ++i) simulation_.parameters().set(element.first_value + i, values[i]);
}

// What the transform of an element makes of the world: world_from_node behind it.
glm::dmat4 SceneEntities::world_from_element(const std::string& element) {
  const Scene& built = scene().scene;
  const NodePtr wanted = built.find_node(element);
  glm::dmat4 found(1);
  walk_graph(*built.root(), {.visit = [&](const Node& node, const WalkState& state) {
    if (&node == wanted.get()) found = state.world_from_node;
  }});
  return found;
}

// Only the pose of the one element changes: what stands in front of it and behind it stays, scale included.
void SceneEntities::place(const std::string& entity, const ros::EntityState& state) {
  constexpr double kTolerance = 1e-9;  // of unit vectors, and of coordinates of 1 m; the products round to some 1e-15
  require(entity);
  const glm::dmat4 wanted =
      world_from_frame(state.header.frame_id) * matrix_of_message(state.pose, ros::SetEntityStateRequest::kInvalidPose);
  if (!world_from(entity)) throw ServiceRefusal(Result::kFailed, in_quotes(entity) + " is switched off");
  const ElementDescriptor element = scene().parameters.elements()[pose_element(entity)];
  const glm::dmat4 before = matrix_of_pose(scene().parameters.values().subspan(element.first_value, kPoseValues));
  const glm::dmat4 world_from_moved = world_from_element(element.name);
  const glm::dmat4 now = scene().scene.world_from_point(entity).value();
  const glm::dmat4 moved_from_entity = glm::inverse(world_from_moved) * now;
  const glm::dmat4 scale = rigid_inverse(world_from(entity).value()) * now;
  const glm::dmat4 after = before * glm::inverse(world_from_moved) * wanted * scale * glm::inverse(moved_from_entity);
  const auto is_there = [&] {
    const glm::dmat4 there = world_from(entity).value_or(glm::dmat4(0));
    const double size_m = 1 + glm::length(glm::dvec3(wanted[3])) + glm::length(glm::dvec3(now[3]));
    for (int column = 0; column < 4; ++column) {
      const double tolerance = kTolerance * (column < 3 ? 1 : size_m);
      if (!(glm::length(there[column] - wanted[column]) <= tolerance)) return false;
    }
    return true;
  };
  if (is_rigid(after, kTolerance)) set_pose(element, after);
  if (!is_there()) {
    set_pose(element, before);
    throw ServiceRefusal(Result::kFailed, in_quotes(entity) + " can't be put there: other elements move it too");
  }
  placed_.insert(entity);
}

bool SceneEntities::is_taken(const std::string& name) {
  const BuiltScene& built = scene();
  return built.scene.has_insertion_point(name) || built.scene.find_node(name) != nullptr || has_sensor(name);
}

bool SceneEntities::has_sensor(const std::string& name) {
  return std::ranges::count(scene().sensors, name, &BuiltSensor::name) > 0;
}

bool SceneEntities::has_element(const std::string& name) {
  return std::ranges::any_of(scene().parameters.elements(),
                             [&](const ElementDescriptor& each) { return !each.removed && each.name == name; });
}

// Every name that is not taken would do; this one says what it moves.
std::string SceneEntities::free_element(const std::string& entity) {
  std::string base;
  for (const char c : entity) base += kNameCharacters.find(c) == kNameCharacters.npos ? '_' : c;
  std::string name = base + "_pose";
  for (int i = 2; is_taken(name) || has_element(name); ++i) name = base + "_pose_" + std::to_string(i);
  return name;
}

std::string SceneEntities::free_name(const ros::EntitySpawn& request, const std::string& stem) {
  constexpr std::size_t kMaxLength = 200;
  std::string name = request.name;
  if (name.empty() && request.allow_renaming) {
    for (const char c : stem) name += kNameCharacters.find(c) == kNameCharacters.npos ? '_' : c;
  }
  if (name.empty() || name.size() > kMaxLength || name.find_first_not_of(kNameCharacters) != name.npos) {
    throw ServiceRefusal(
        Spawn::kNameInvalid,
        "name " + in_quotes(name) + ", expected letters, digits, _ and -, at most " + std::to_string(kMaxLength));
  }
  if (!is_taken(name)) return name;
  if (!request.allow_renaming) {
    throw ServiceRefusal(Spawn::kNameNotUnique, in_quotes(name) + " is there already, expected another name");
  }
  int number = 2;
  while (is_taken(name + "_" + std::to_string(number))) ++number;
  return name + "_" + std::to_string(number);
}

std::string SceneEntities::spawn(const ros::EntitySpawn& request) {
  const std::string file = file_of(request.entity_resource);
  require_no_namespace(request.entity_namespace);
  const std::string name = free_name(request, std::filesystem::path(file).stem().string());
  const ros::PoseStamped& at = request.initial_pose;
  const glm::dmat4 pose = world_from_frame(at.header.frame_id) * matrix_of_message(at.pose, Spawn::kInvalidPose);
  std::vector<double> values(kPoseValues);
  write_pose(pose, values);
  Attributes element = {{"type", "pose"}, {"name", free_element(name)}, {"insert_at", name}};
  for (std::size_t i = 0; i < kPoseValues; ++i) {
    element.emplace_back(kPoseRows[i].name, format_number(values[i]));
  }
  const std::size_t number = simulation_.parameters().changes().size();
  try {
    folders_.check(folders_.start() / file);
    if (!is_there(folders_.start() / file)) {
      throw ServiceRefusal(Result::kNotFound, "there is no file " + in_quotes(file));
    }
    execute(to_xml(CommandKind::part, {{"file", file}, {"name", name}, {"insert_at", "ROOT"}}) +
            to_xml(CommandKind::element, element));
  } catch (const Error& error) {  // of the machine too: a file that takes too long does not end the run
    const bool is_of_file = std::string_view(error.what()).find("part " + name + ": ") != std::string_view::npos;
    throw ServiceRefusal(is_of_file ? Spawn::kResourceParseError : Result::kFailed,
                         without_file_content(error.what(), request.entity_resource.uri + request.name));
  }
  spawned_.push_back(number);
  return name;
}

void SceneEntities::remove(const std::string& entity) {
  require(entity);
  execute(to_xml(CommandKind::remove, {{"name", entity}, {"kind", "part"}}));
}

bool SceneEntities::stands(const Command& made) {
  const std::string& name = made.require("name").value;
  if (made.kind == CommandKind::part) return scene().scene.has_part(name);
  return made.kind == CommandKind::element ? has_element(name) : has_sensor(name);
}

// Removes the last one first, because commands refer to what stands before them. In one request they may also refer to
// sensors that follow, so what can't be removed yet is tried again.
void SceneEntities::remove_made_by(std::span<const std::size_t> commands) {
  std::vector<Command> left;
  for (auto each = commands.rbegin(); each != commands.rend(); ++each) {
    left.push_back(logged_command(simulation_.parameters().changes()[*each]));
  }
  while (!left.empty()) {
    std::vector<Command> refused;
    std::exception_ptr why;
    for (const Command& made : left) {
      if (!stands(made)) continue;  // it has gone with another one
      try {
        execute(to_xml(CommandKind::remove,
                       {{"name", made.require("name").value}, {"kind", std::string(to_string(made.kind))}}));
      } catch (const InputError&) {
        refused.push_back(made);
        why = std::current_exception();
      }
    }
    if (refused.size() == left.size()) std::rethrow_exception(why);
    left = std::move(refused);
  }
}

void SceneEntities::remove_spawned() {
  const std::vector<std::size_t> standing = standing_commands(simulation_.parameters().changes());
  std::erase_if(spawned_, [&](std::size_t each) { return !std::ranges::binary_search(standing, each); });
  remove_made_by(spawned_);
}

void SceneEntities::remove_added() {
  const std::vector<std::string>& log = simulation_.parameters().changes();
  const std::vector<std::size_t> standing = standing_commands(log);
  const auto [here, there] = std::ranges::mismatch(standing, start_);
  if (there != start_.end()) {
    const Command removed = logged_command(log[*there]);
    throw InputError(std::string(to_string(removed.kind)) + " " + removed.require("name").value +
                     " was removed, expected all that the scene had at the start: a reset makes nothing again");
  }
  remove_made_by({here, standing.end()});
  placed_.clear();
}

void SceneEntities::execute(const std::string& xml) {
  folders_.carry_out([&] {
    folders_.parse(xml, kRequestName);  // throws if it names a file elsewhere
    simulation_.execute(xml, folders_.start(), kRequestName);
  });
}

}  // namespace simvis
