// The lights and the sky of an MJCF model.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "import/mjcf/mjcf_tree.h"
#include "import/model/import_report.h"
#include "import/model/model_light.h"

namespace simvis {

struct MjcfLight {
  MjcfElement element;
  std::string name;    ///< of its element `light`
  std::string prefix;  ///< of the names in its model
  std::size_t body = 0;
  glm::dmat4 body_from_frame{1.0};  ///< of the <frame> elements around it
};

/// Collects lights and makes elements `light` and `sky` of them.
///
/// MuJoCo adds light in sRGB-encoded numbers: a white surface that faces a light of diffuse colour D shows D, and here
/// the linear colour of that. A lamp, which falls off here with the square of the distance, is as bright as MuJoCo's at
/// the origin of its body, or at the body that it is aimed at. Specular colours and exponents are not taken over.
///
/// The headlight, which shines from the camera, and ambient light are that of an element `sky`, if the model has lights
/// or a <headlight>: on a ball, the headlight's diffuse part is 2/3 in the mean of the picture. The background of this
/// element is the colour of the sky box at the horizon, if the model has one.
class MjcfLights {
 public:
  explicit MjcfLights(ImportReport& report) : report_(report) {}
  void add(MjcfLight light) { lights_.push_back(std::move(light)); }

  /// The commands, lights in the order of add(). `sky` is the name of the element `sky`. A light with an unknown type
  /// or wrong numbers is left out with a warning. Throws InputError for wrong numbers of the headlight and the sky box.
  std::vector<std::string> commands(const MjcfTree& tree, const std::string& sky);

 private:
  ModelLight read(const MjcfLight& light, const MjcfTree& tree, const std::vector<glm::dmat4>& file_from_body);
  // From the light to what it lights.
  glm::dvec3 way_of(const MjcfLight& light, const MjcfTree& tree, const std::vector<glm::dmat4>& file_from_body,
                    const glm::dvec3& position_m);

  ImportReport& report_;
  std::vector<MjcfLight> lights_;
};

}  // namespace simvis
