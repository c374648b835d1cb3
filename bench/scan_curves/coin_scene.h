// A draw list as Coin would hold it.
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

/// Triangles alone: for each item a separator with its matrix and an indexed face set, one per mesh. No lights, so that
/// drawing costs the least. Starts Coin if need be.
CoinScene make_coin_scene(const DrawList& list);

SbVec3f to_coin(const glm::dvec3& v);

}  // namespace simvis::bench
