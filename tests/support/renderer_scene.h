// Small scenes for the renderer's tests, built by hand.
#pragma once

#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <simvis/device.h>
#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include "engine/render/renderer.h"
#include "tests/support/tested_build.h"

namespace simvis::test {

/// A rectangle in the plane z = 0 of its frame, seen from -z: corners (x0, y0) to (x1, y1), y down, front towards -z.
Mesh rectangle(float x0, float y0, float x1, float y1);

inline glm::dmat4 at(double x, double y, double z) {
  glm::dmat4 m(1);
  m[3] = {x, y, z, 1};
  return m;
}

/// A draw list that grows by whole items.
struct RendererScene {
  DrawList list;

  RendererScene();

  std::uint32_t add_mesh(Mesh mesh);
  std::uint32_t add_material(Material material);
  std::uint32_t add_transform(const glm::dmat4& m);
  void add(std::uint32_t mesh, std::uint32_t material, const glm::dmat4& m);
  void add(Mesh mesh, Material material, const glm::dmat4& m);
  void add_light(const Light& light, const glm::dmat4& m);
};

/// One view that fills one pass; the world is the view's frame. A square of 90 degrees when width = height = 2 * f.
FramePlan plan_of(std::uint32_t width, std::uint32_t height, double f_px, bool color, bool depth);

inline View& view_of(FramePlan& plan) { return plan.passes[0].views[0]; }

template <typename T>
std::vector<T> copy(std::span<const T> values) {
  return {values.begin(), values.end()};
}

template <typename T>
bool same_bytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

/// The device of a test program, made once. Its cache lies in a folder of the build tree.
inline Device& device() {
  static Device instance({.select = "", .validation = false, .cache_dir = tested_build() + "/test_cache"});
  return instance;
}

inline constexpr float kBackground = 0.25f;

RendererScene scene_with_ambient(double ambient);

Material colored(glm::vec4 base);

// 4 x 1 texels of clear grey levels, with alpha in steps.
inline constexpr int kGrey[4] = {30, 90, 170, 250}, kAlpha[4] = {0, 100, 200, 255};
std::shared_ptr<Texture> four_texels();

// A wall that fills a 4 x 4 view: one texel of `four_texels` per column when uv runs from 0 to 1.
RendererScene textured_wall(Material material);

inline FramePlan wall_plan(bool color, bool depth) { return plan_of(4, 4, 2, color, depth); }

}  // namespace simvis::test
