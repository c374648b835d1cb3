// VRML text that Coin can read.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

/// The fields of the node with this name in the version of the text; empty: there is no such node.
using VrmlFields = std::function<std::optional<std::set<std::string, std::less<>>>(const std::string& node)>;

struct VrmlText {
  std::string text;
  std::vector<std::string> warnings;  ///< FILE:LINE:COLUMN: WHAT, one for each kind
};

/// Throws InputError for what Coin would refuse without the cause, or crash on: X3D in XML, and with the place for
/// nodes nested deeper than 1000. Binary files pass.
void check_vrml(std::string_view text, const std::string& shown);

/// The text without what Coin refuses a whole file for: fields and nodes that VRML97 or VRML 1 does not have, and
/// EXTERNPROTOs of files that are not there, with their nodes. An empty group takes the place of a node. Lines keep
/// their numbers. Empty: the text stays as it is, because there is nothing to leave out, it is neither of them, or Coin
/// finds its fault. Throws InputError with the place for a node within itself (DEF and USE) and a PROTO that uses
/// itself, at which Coin crashes.
std::optional<VrmlText> readable_vrml(std::string_view text, const std::filesystem::path& file,
                                      const std::string& shown, const VrmlFields& fields);

}  // namespace simvis
