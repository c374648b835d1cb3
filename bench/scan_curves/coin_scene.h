// Converts a draw list to a Coin scene.
#pragma once

#include <Inventor/SbLinear.h>
#include <Inventor/nodes/SoSeparator.h>

#include <glm/glm.hpp>
#include <memory>

#include <simvis/draw_list.h>

namespace simvis::bench {

struct Unref {
  void operator()(SoNode* node) const { node->unref(); }
};
using CoinScene = std::unique_ptr<SoSeparator, Unref>;

/// Only triangles: for each item a separator with its matrix and an indexed face set, one per mesh. There are no
/// lights, so that drawing is as cheap as possible. Initialises Coin if necessary.
CoinScene make_coin_scene(const DrawList& list);

SbVec3f to_coin(const glm::dvec3& v);

}  // namespace simvis::bench
