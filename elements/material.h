// The element `material`: changes the look of one part; other parts from the same file do not change.
//
//   <element type="material" name="PAINT" insert_at="ROOT" part="TABLE" material="Wood" red="0.5" roughness="0.2"/>
//
// Parameters  are live and relative to the file, so that an attribute that is not given changes nothing. red green
//          blue, opacity and roughness are factors. emission_red, emission_green and emission_blue are added (W/(sr
//          m^2) or cd/m^2, the unit of the scene's lights). The colour multiplies the texture, as glTF's base colour
//          factor does. If the opacity is below 1 the surface is blended. If it is below one half, depth cameras and
//          scanners see through the surface.
// Opacity  `fixed_opacity` is not live. It replaces the file's opacity, and what else the file says about transparency
//          except the cut-outs of masks, before the factors apply.
// Lasers   `reflectance` and `retro_reflectance` are not live. They are absolute values for lasers, not factors,
//          because a colour says little about the near infrared. If several elements set them on one material, the last
//          one applies. `mirror` and `transmission` (see engine/light/surface_shares.h) are shares: each turns this
//          share of the remaining surface into a mirror or into glass. refractive_index is a factor.
// Reach    the part's own file: parts, elements and sensors that were inserted at the part keep their look.
// Several  material and foliage elements on one part act together: factors multiply, emissions add up, and each share
//          of mirror or glass applies to the surface that the elements before it left.
// Special  Roughness and emission have no effect on unlit materials, which show their colour only.
#pragma once

#include <simvis/element.h>
#include <simvis/node.h>

namespace simvis {

class MaterialElement : public Element {
 public:
  /// Throws InputError at the attribute if the part does not exist, has no materials or has no material of that name.
  explicit MaterialElement(const ElementContext& context);
  void update(ParameterView values) override;

 private:
  // A material of the part, and the number of this element's change in it.
  struct Changed {
    std::shared_ptr<MaterialNode> node;
    std::size_t number;
  };
  std::vector<Changed> changed_;
  MaterialChange change_;
};

}  // namespace simvis
