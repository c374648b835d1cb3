// The models that <attach> elements of an MJCF model name.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "import/mjcf/mjcf_tree.h"

namespace simvis {

/// Content of another model. What it names, such as meshes and classes of defaults, is that model's own.
struct MjcfAttached {
  const MjcfModel* model = nullptr;
  std::optional<MjcfElement> body{};  ///< none: all that the model's world holds
};

class MjcfAttachments {
 public:
  /// Models are kept in the tree.
  explicit MjcfAttachments(MjcfTree& tree) : tree_(tree) {}

  /// What an <attach> names. Each file is read once. Throws InputError at the element: no <asset><model> of that name,
  /// a file that is not there or is no MJCF, no such body in it; and what is wrong in that file.
  MjcfAttached find(const MjcfElement& attach);

 private:
  const MjcfModel& model_of(const MjcfElement& asset);

  MjcfTree& tree_;
  std::map<std::filesystem::path, const MjcfModel*> read_;
};

}  // namespace simvis
