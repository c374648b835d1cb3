// The lights of a running simulation's scene, with less than all of their effects.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <simvis/node.h>
#include <simvis/simulation.h>

namespace simvis {

/// What drawn pictures show of the light of a scene. Each value adds to the one before it.
enum class DrawnLight : std::uint8_t {
  plain,    ///< lamps without shadows, each as one light, and ambient light everywhere
  shadows,  ///< objects block lamps
  sizes,    ///< lamps with a size are several lights
  sky       ///< ambient light and skies are distant lights that objects block
};

/// Changes what the next steps draw. Lights whose parameters change meanwhile are as the scene has them.
///
/// Limit     SIMVIS_MAX_SHADOWS lights have shadows; those behind have none. The ambient light becomes as many lights
/// as
///           are left.
/// Lifetime  the simulation must live as long as the object.
class SceneLights {
 public:
  /// The simulation has made a frame. No command is executed in it any more.
  explicit SceneLights(const Simulation& simulation);

  /// Whether this differs from what is below it.
  bool offers(DrawnLight light) const;
  void show(DrawnLight light);
  /// As the scene has them.
  void restore();

 private:
  struct Held {
    std::shared_ptr<Group> parent;
    std::shared_ptr<LightNode> node;
    Light own;
    NodePtr stand_in{};       // in the node's place while it is not shown
    std::uint32_t count = 1;  // of its occurrences in the scene
    bool shown = true;
  };
  void find(const std::shared_ptr<Group>& group);
  void hold(const std::shared_ptr<Group>& parent, const std::shared_ptr<LightNode>& light);
  void show(Held& held, bool shown);
  void set_ambient(const glm::vec3& ambient, std::uint32_t lights);

  std::shared_ptr<Group> root_;
  std::vector<Held> lights_;
  std::shared_ptr<EnvironmentNode> environment_;
  Environment own_;
  std::shared_ptr<Separator> sky_ = std::make_shared<Separator>();
  bool has_sky_ = false;
};

}  // namespace simvis
