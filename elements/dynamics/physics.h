// The element `physics`: bodies of the scene move as forces and contacts say.
//
//   <element type="physics" name="PHYSICS" insert_at="ROOT" step="1"/>
//
// A scene has at most one, before its bodies. It applies to the whole scene, independent of insert_at.
// Parameters  running (0 or 1), restarts (a count), both live.
#pragma once

#include <memory>

#include "elements/dynamics/dynamic_scene.h"

namespace simvis {

class PhysicsElement : public Element, public Stateful {
 public:
  /// Throws InputError for a second one, MachineError if the engine is missing.
  explicit PhysicsElement(const ElementContext& context);
  void update(ParameterView values) override;
  bool moves_itself() const override { return true; }
  void advance(std::int64_t time_ns, std::span<double> values) override;
  void archive(StateArchive& state) override {
    state(restarts_);
    dynamic_->archive(state);
  }

 private:
  std::shared_ptr<DynamicScene> dynamic_;
  std::optional<double> restarts_;
};

}  // namespace simvis
