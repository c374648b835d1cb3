// The bodies that hold together in a scene.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "elements/dynamics/dynamic_object.h"
#include "elements/dynamics/world/world.h"

namespace simvis {

/// The insertion point that stands for the world.
inline constexpr std::string_view kAttachedWorld = "ROOT";

/// Two insertion points whose bodies hold together.
struct Attachment {
  std::string name;  ///< of its element
  std::string a, b;  ///< insertion points; ROOT: the world
  bool is_wanted = true;
  struct Held {
    std::size_t constraint;
    WorldLink a, b;  // b of the world: any
  };
  std::optional<Held> held{};  ///< in the world
};

/// All attachments of a scene.
class Attachments {
 public:
  void add(Attachment& attachment);
  void remove(Attachment& attachment);
  /// The one that holds the same two bodies' points; null if there is none.
  const Attachment* find(const std::string& a, const std::string& b) const;
  /// The world is a new one.
  void restart();
  /// Before the steps of a frame: attaches and releases what has changed. Those whose body has gone hold nothing.
  void act(DynamicsWorld& world, std::span<DynamicObject* const> objects);

 private:
  std::vector<Attachment*> attachments_;  // by name
  std::vector<std::size_t> released_;     // constraints of those that were removed
};

}  // namespace simvis
