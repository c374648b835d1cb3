// The models of an SDF file as plain data, with all included files in their places.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "import/sdf/sdf_element.h"

namespace simvis {

struct SdfScope;

enum class SdfItemKind : std::uint8_t { link, frame, joint, model };

/// Something with a pose, to which other poses may refer by name.
struct SdfItem {
  SdfItemKind kind = SdfItemKind::link;
  std::string name;  ///< unique among the items of its kind in the scope
  SdfElement element;
  SdfPose pose;
  std::string parent, child;          ///< names of a joint's links; `child` of a frame is what it is attached to
  std::unique_ptr<SdfScope> scope{};  ///< of a model

  enum class Progress : std::uint8_t { unknown, under_way, known };
  Progress progress = Progress::unknown;  ///< of scope_from_item
  glm::dmat4 scope_from_item{1.0};        ///< see SdfPoses
};

/// A model or the world: the names in it belong to it.
struct SdfScope {
  SdfScope* outer = nullptr;  ///< null: the world
  SdfItem* item = nullptr;    ///< the model in `outer`
  std::string placement_frame, canonical_link;
  bool is_merged = false;                ///< its names are also names of `outer`
  bool is_static = false;                ///< physics does not move it
  std::optional<std::uint32_t> label{};  ///< of the visuals of its links, see sdf_labels.h
  SdfElement element;
  std::vector<std::unique_ptr<SdfItem>> items{};
  std::map<std::string, SdfItem*, std::less<>> by_name{};
  std::map<std::pair<SdfItemKind, std::string>, int> last_number{};  ///< behind a name that was there already
};

/// A light of the world.
struct SdfWorldLight {
  SdfElement element;
  std::string name;
  SdfPose pose;
};

struct SdfContent {
  std::vector<std::unique_ptr<SdfFile>> files;
  SdfScope world;
  std::vector<SdfWorldLight> lights;
  SdfElement scene;              ///< the world's <scene>, if there is one
  SdfElement first;              ///< the world, or the first model or light
  bool is_single_model = false;  ///< the file is a model and no world
};

}  // namespace simvis
