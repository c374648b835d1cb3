// A scene under construction: the graph from ROOT down, its insertion points, and the content that parts share.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scenegraph/command.h"
#include "scenegraph/content_pool.h"
#include "scenegraph/name_set.h"
#include "scenegraph/node.h"

namespace simvis {

/// What a part file became.
struct PartContent {
  NodePtr root;                       ///< may stand under several parents
  std::vector<std::string> warnings;  ///< for people, each with the file's name
  std::vector<std::string> commands;  ///< embedded commands, XML text, in the order found
  std::filesystem::path file;         ///< the canonical name; set by Scene
};

/// Frames   the world is ROOT's frame: x forward, y left, z up, metres.
/// Attributes of a part  file (a relative name starts at the command's folder), name, insert_at, pose_offset, up.
/// Names    insertion points, parts, elements and sensors each have a name of their own; two of a kind never share one.
class Scene {
 public:
  Scene();

  const GroupPtr& root() const { return root_; }

  /// Executes a part command: separator { offset, insertion point NAME, content } right before its `insert_at`.
  /// Returns the part's content; to execute the commands that it carries is up to the caller.
  /// Throws InputError with the place: an attribute that is missing, unknown or wrong, an unknown insertion point, a
  /// name already taken, a file that is missing, of an unknown kind or broken.
  const PartContent& insert_part(const Command& command);

  /// Puts `node` right before the insertion point named by the command's `insert_at`.
  /// Throws InputError when there is no such insertion point (the nearest name suggested).
  void insert(const Command& command, NodePtr node);

  bool has_insertion_point(std::string_view name) const;
  std::vector<std::string_view> insertion_points() const;

  /// Messages of importers that did not stop them, in the order they came, each once.
  const std::vector<std::string>& warnings() const { return warnings_; }

  ContentPool& pool() { return pool_; }

 private:
  struct Place {
    Group* parent;
    InsertionPoint* point;
  };
  const Place& place(const Command& command) const;
  const PartContent& load(const Command& command);

  GroupPtr root_;
  std::map<std::string, Place, std::less<>> places_;
  NameSet part_names_{"part"};
  std::map<std::string, PartContent> parts_;  ///< by canonical path and up axis: one file is read once
  ContentPool pool_;
  std::vector<std::string> warnings_;
};

/// Throws what went wrong inside a part as an error of the command that inserts it:
/// "scene.xml:3:2: error: part WORLD: world.glb: ...".
[[noreturn]] void rethrow_from_part(const Command& part, const InputError& error);

}  // namespace simvis
