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
  struct Bodies {
    WorldLink a;
    std::optional<WorldLink> b;  ///< none: the world
    bool operator==(const Bodies&) const = default;
    void archive(StateArchive& state) { state(a, b); }
  };
  std::optional<Bodies> bodies{};  ///< as Attachments has found them; empty: there is nothing to hold
  struct Held {
    std::size_t constraint = 0;
    Bodies bodies{};
    void archive(StateArchive& state) { state(constraint, bodies); }
  };
  std::optional<Held> held{};  ///< in the world
};

/// All attachments of a scene.
class Attachments {
 public:
  void add(Attachment& attachment);
  void remove(Attachment& attachment);
  /// Returns the attachment of `a` to `b` or of `b` to `a`; null if there is none.
  const Attachment* find(const std::string& a, const std::string& b) const;
  /// Bodies have come or gone: the next act() looks for them again.
  void forget_bodies() { is_found_ = false; }
  /// Forgets all constraints. Called when the world has been made anew.
  void restart();
  /// Attaches and releases what has changed. Called before the steps of a frame. An attachment whose body has gone
  /// holds nothing.
  void act(DynamicsWorld& world, std::span<DynamicObject* const> objects);
  /// Writes or reads which attachments hold; see DynamicScene::archive().
  void archive(StateArchive& state);

 private:
  std::vector<Attachment*> attachments_;  // by name
  std::vector<std::size_t> released_;     // constraints of those that were removed
  bool is_found_ = false;                 // what all of them hold
};

}  // namespace simvis
