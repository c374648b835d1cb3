// What a stage of USD says of links, joints, masses and collisions.
#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <utility>

#include "import/gltf/gltf_document.h"
#include "import/model/model_description.h"

namespace simvis {

/// Processor time of the program that reads USD: Python and usd-core take most of a second to start.
inline constexpr std::chrono::seconds kUsdTime{60};

/// The model in the answer of the program that reads USD (import/programs/usd/usd_physics.py), which is not trusted.
/// Throws InputError naming the document's file.
ModelDescription read_usd_model(const nlohmann::json& model, GltfDocument& document, ContentPool& pool);

/// A stage whose model has been read.
class UsdSource : public ModelSource {
 public:
  explicit UsdSource(ModelDescription description) : read_(std::move(description)) {}
  /// USD's gravity and steps are not taken over.
  ModelWorld world() override { return {}; }

 private:
  ModelDescription describe(ContentPool&) override { return read_; }
  ModelDescription read_;
};

}  // namespace simvis
