// KHR_materials_pbrSpecularGlossiness, the archived extension of many models of public collections.
#pragma once

#include <nlohmann/json.hpp>

namespace simvis {

/// Gives the materials of the file that have the extension and no metallic-roughness model, which would be their
/// fallback, such a model: the diffuse colour and picture as base colour, no metal, and roughness 1 - glossiness. Call
/// it before the document is checked. Returns whether there was such a material.
bool read_specular_glossiness(nlohmann::json& root);

}  // namespace simvis
