// The element `material`: changes how a part looks, without touching other parts of the same file.
//
//   <element type="material" name="PAINT" insert_at="ROOT" part="TABLE" material="Wood" red="0.5" roughness="0.2"/>
//
// Parameters  all live, relative to what the file says, so that what is not given stays as it is: red green blue,
//          opacity and roughness are factors, emission_red and so on are added (W/(sr m^2) or cd/m^2, as the scene's
//          lights are meant). The colour multiplies the texture, as glTF's base colour factor does.
//          Below an opacity of 1 the surface is blended; below one half depth cameras and scanners look through it.
// Lasers   `reflectance` and `retro_reflectance` are not live, and are what lasers then see, not factors: a colour
//          says little of the near infrared. Of several elements on one material the last counts.
//          For lasers (see effects/specular_path.h) mirror and transmission are shares: what is not yet a mirror, or
//          glass, becomes it by that share; refractive_index is a factor.
// Reach    the part's own file: parts, elements and sensors that were inserted there keep their look.
// Several  material and foliage elements on one part act together: factors multiply, emissions add up, and
//          of what one leaves matte the next takes its share.
// Special  unlit materials show their colour and nothing else: roughness and emission do nothing to them.
#pragma once

#include <optional>

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class MaterialElement : public Element {
 public:
  /// Throws InputError at the attribute: no such part, a part without materials or without one of that name.
  explicit MaterialElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  // A material of the part, and which of its changes is this element's.
  struct Changed {
    std::shared_ptr<MaterialNode> node;
    std::size_t number;
  };
  std::vector<Changed> changed_;
  std::optional<float> reflectance_, retro_reflectance_;
};

}  // namespace simvis
