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
#include "scenegraph/node.h"

namespace simvis {

/// What a part file became.
struct PartContent {
  NodePtr root;                       ///< may stand under several parents
  std::vector<std::string> warnings;  ///< for people, each with the file's name
  std::vector<std::string> commands;  ///< embedded commands, XML text, in the order found
};

/// Frames   the world is ROOT's frame: x forward, y left, z up, metres.
/// Names    insertion points, parts, elements and sensors each have a name of their own; two of a kind never share one.
class Scene {
 public:
  Scene();

  const GroupPtr& root() const { return root_; }

  /// Executes a part command: separator { offset, insertion point NAME, content } right before its `insert_at`.
  /// Throws InputError with the place: unknown insertion point, a name already taken, a file that cannot be read.
  void insert_part(const Command& command);

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
  const PartContent& load(const std::filesystem::path& file, std::string_view up, const Location& where);

  GroupPtr root_;
  std::map<std::string, Place, std::less<>> places_;
  std::map<std::string, PartContent> parts_;  ///< by canonical path and up axis: one file is read once
  ContentPool pool_;
  std::vector<std::string> warnings_;
};

}  // namespace simvis
