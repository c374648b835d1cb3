// Names of one kind of thing, of which no two may be the same.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include <simvis/command.h>

namespace simvis {

class NameSet {
 public:
  /// `kind` is what messages call the things: "part", "element".
  explicit NameSet(std::string_view kind) : kind_(kind) {}

  /// Throws InputError at the attribute if the name is taken, and says by whom.
  void claim(const CommandAttribute& name);

  /// Gives a claimed name back.
  void release(const std::string& name) { places_.erase(name); }

  bool contains(const std::string& name) const { return places_.contains(name); }

  /// Takes a name that no command gave.
  void reserve(std::string name) { places_.emplace(std::move(name), Location{}); }

 private:
  std::string_view kind_;
  std::map<std::string, Location> places_;
};

}  // namespace simvis
