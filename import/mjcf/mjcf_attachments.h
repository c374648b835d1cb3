// The models that <attach> elements of an MJCF model name.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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
  // The <asset><model> elements of a model: by their names, and those without one, which have the name of their model.
  struct Named {
    std::map<std::string, MjcfElement> by_name{};
    std::vector<MjcfElement> others{};
  };
  const Named& names_in(const MjcfModel& model);
  const MjcfModel* find_model(const MjcfElement& attach, const std::string& name);
  const MjcfModel& model_of(const MjcfElement& asset);
  const MjcfElement* find_body(const MjcfModel& model, const std::string& name);

  MjcfTree& tree_;
  std::map<std::filesystem::path, const MjcfModel*> read_;
  std::map<const MjcfModel*, Named> names_;
  std::map<std::pair<const MjcfModel*, std::string>, const MjcfModel*> found_;
  std::map<const MjcfModel*, std::map<std::string, MjcfElement>> bodies_;
};

}  // namespace simvis
