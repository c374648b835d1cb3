// Transparent surfaces compared with Porter and Duff's "over", computed per sample from planes in double.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numeric>
#include <optional>

#include <simvis/effect.h>
#include "shaders/interop.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("effects");

using namespace simvis;
using namespace simvis::test;

namespace {

// Each of N layers with values up to 1 adds 5 roundings of float32 (2^-24); the mean of the samples and the background
// add a few.
constexpr double over_rounding(std::size_t layers) { return (5.0 * static_cast<double>(layers) + 8) / (1 << 24); }
// The relative error of a plane's depth is about ten roundings of float32. Closer surfaces may be in either order.
constexpr double kDepthRounding = 2e-6;

struct Glass {
  glm::vec4 color;
  glm::dmat4 place;
};

Material glass_material(const glm::vec4& color) {
  Material material = colored(color);
  material.alpha_mode = AlphaMode::blend;
  material.unlit = material.double_sided = true;
  return material;
}

/// Planes that cross each other all over the view and fill it.
std::vector<Glass> crossing() {
  const auto turned = [](double z, double angle, glm::dvec3 axis) {
    return glm::rotate(at(0.1, -0.05, z), angle, glm::normalize(axis));
  };
  return {{{0.9f, 0.2f, 0.1f, 0.5f}, turned(4, 0.5, {0, 1, 0})},
          {{0.1f, 0.8f, 0.3f, 0.25f}, turned(4.1, -0.6, {0, 1, 0})},
          {{0.2f, 0.3f, 0.7f, 0.75f}, turned(3.9, 0.6, {1, 0, 0})},
          {{0.6f, 0.6f, 0.1f, 0.375f}, turned(4.3, -0.4, {1, 0.3, 0})},
          {{0.3f, 0.9f, 0.9f, 0.125f}, turned(4.2, 0.1, {1, 1, 0})}};
}

const Mesh kPane = rectangle(-50, -50, 50, 50);

RendererScene scene_of(const std::vector<Glass>& panes) {
  RendererScene scene = scene_with_ambient(1);
  for (const Glass& pane : panes) scene.add(kPane, glass_material(pane.color), pane.place);
  return scene;
}

/// Depth of a pane along the ray through (x, y, 1); empty if the ray points away from it.
std::optional<double> depth_of(const Glass& pane, const glm::dvec2& ray) {
  const glm::dvec3 normal(pane.place[2]), way(ray, 1);
  const double depth = glm::dot(normal, glm::dvec3(pane.place[3])) / glm::dot(normal, way);
  return depth > 0 ? std::optional(depth) : std::nullopt;
}

/// Empty where rounding decides the order of two panes.
std::optional<glm::dvec3> over(const std::vector<Glass>& panes, const glm::dvec2& ray, double solid_at_m) {
  std::vector<std::pair<double, glm::dvec4>> layers;
  for (const Glass& pane : panes) {
    const std::optional<double> depth = depth_of(pane, ray);
    if (depth && *depth < solid_at_m) layers.push_back({*depth, glm::dvec4(pane.color)});
  }
  std::ranges::sort(layers, std::greater<>(), [](const auto& layer) { return layer.first; });
  glm::dvec3 seen(kBackground);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if (i > 0 && layers[i - 1].first - layers[i].first < kDepthRounding * layers[i].first) return std::nullopt;
    seen = glm::dvec3(layers[i].second) * layers[i].second.a + seen * (1 - layers[i].second.a);
  }
  return seen;
}

constexpr std::uint32_t kPaneSize = 48;
FramePlan square_plan(std::uint32_t supersampling = 1, std::uint32_t msaa = 1) {
  FramePlan plan = plan_of(kPaneSize, kPaneSize, kPaneSize / 2.0, true, false);
  plan.passes[0].supersampling = supersampling;
  plan.passes[0].msaa = msaa;
  return plan;
}

glm::dvec2 ray_of(double x_px, double y_px) {
  return {(x_px - kPaneSize / 2.0) / (kPaneSize / 2.0), (y_px - kPaneSize / 2.0) / (kPaneSize / 2.0)};
}

/// The sample positions in a pixel. Four samples: Vulkan's standard locations.
std::vector<glm::dvec2> sample_places(std::uint32_t supersampling, std::uint32_t msaa) {
  const std::vector<glm::dvec2> within =
      msaa == 4 ? std::vector<glm::dvec2>{{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}}
                : std::vector<glm::dvec2>{{0.5, 0.5}};
  std::vector<glm::dvec2> places;
  for (std::uint32_t i = 0; i < supersampling * supersampling; ++i) {
    for (const glm::dvec2& p : within)
      places.push_back((glm::dvec2(i % supersampling, i / supersampling) + p) / double(supersampling));
  }
  return places;
}

/// The number of pixels that differ from "over" by more than rounding, and of pixels that could be compared.
std::pair<int, int> compare(std::span<const glm::vec4> seen, const std::vector<Glass>& panes,
                            std::uint32_t supersampling, std::uint32_t msaa,
                            double solid_at_m = std::numeric_limits<double>::infinity()) {
  int wrong = 0, compared = 0;
  const std::vector<glm::dvec2> places = sample_places(supersampling, msaa);
  for (std::uint32_t i = 0; i < kPaneSize * kPaneSize; ++i) {
    glm::dvec3 mean(0);
    bool clear = true;
    for (const glm::dvec2& place : places) {
      const auto sample = over(panes, ray_of(i % kPaneSize + place.x, i / kPaneSize + place.y), solid_at_m);
      clear &= sample.has_value();
      if (sample) mean += *sample / double(places.size());
    }
    if (!clear) continue;
    ++compared;
    const glm::dvec3 off = glm::abs(glm::dvec3(seen[i]) - mean);
    wrong += std::max({off.x, off.y, off.z}) > over_rounding(panes.size()) || seen[i].a != 1;
  }
  return {wrong, compared};
}

}  // namespace

TEST_CASE("crossing panes are blended by depth, per pixel and per sample, in any order") {
  const std::vector<Glass> panes = crossing();
  Renderer renderer(device());
  for (const auto& samples : {std::pair{1u, 1u}, {2u, 1u}, {4u, 1u}, {1u, 4u}, {2u, 4u}}) {
    const std::uint32_t supersampling = samples.first, msaa = samples.second;
    if (std::ranges::find(device().target_limits().msaa, msaa) == device().target_limits().msaa.end()) continue;
    CAPTURE(supersampling);
    CAPTURE(msaa);
    const std::vector<glm::vec4> first =
        copy(renderer.render(scene_of(panes).list, square_plan(supersampling, msaa))[0].color);
    const auto [wrong, compared] = compare(first, panes, supersampling, msaa);
    CHECK(wrong == 0);
    CHECK(compared > int(kPaneSize * kPaneSize * 9 / 10));
    CHECK(renderer.counters().layers ==
          std::uint64_t{kPaneSize} * kPaneSize * supersampling * supersampling * msaa * panes.size());
    std::vector<Glass> turned = panes;
    for (int order = 0; order < 4; ++order) {
      std::rotate(turned.begin(), turned.begin() + 1 + order % 2, turned.end());
      CHECK(same_bytes<glm::vec4>(first,
                                  renderer.render(scene_of(turned).list, square_plan(supersampling, msaa))[0].color));
    }
  }
}

TEST_CASE("faces of one mesh are blended by depth in any index order") {
  // The panes as one mesh, each with its own colour.
  const std::vector<Glass> panes = crossing();
  const auto scene_in = [&](const std::array<std::size_t, 5>& order) {
    Mesh mesh;
    for (const Glass& pane : panes) {
      for (const glm::vec3& p : kPane.positions) {
        mesh.positions.push_back(glm::vec3(pane.place * glm::dvec4(p, 1)));
        mesh.attributes.push_back({.color = pane.color});
      }
    }
    for (const std::size_t pane : order) {
      for (const std::uint32_t i : kPane.indices) mesh.indices.push_back(i + 4 * static_cast<std::uint32_t>(pane));
    }
    compute_bounds(mesh);
    RendererScene scene = scene_with_ambient(1);
    scene.add(mesh, glass_material({1, 1, 1, 1}), glm::dmat4(1));
    return scene;
  };
  Renderer renderer(device());
  std::array<std::size_t, 5> order{0, 1, 2, 3, 4};
  const std::vector<glm::vec4> first = copy(renderer.render(scene_in(order).list, square_plan())[0].color);
  // Vertex colours are stored in 16 bits: each of five layers deviates by half a step in colour and in alpha.
  constexpr double kVertexColor = 5 * 2 * 0.5 / 65535;
  const glm::vec4 seen = first[kPaneSize * 11 + 7];
  const std::optional<glm::dvec3> expected = over(panes, ray_of(7.5, 11.5), 1e9);
  REQUIRE(expected);
  for (int c = 0; c < 3; ++c) CHECK(std::abs(seen[c] - (*expected)[c]) < kVertexColor + over_rounding(5));
  for (int i = 0; i < 6; ++i) {
    std::rotate(order.begin(), order.begin() + 1, order.end());
    std::swap(order[0], order[2]);
    CHECK(same_bytes<glm::vec4>(first, renderer.render(scene_in(order).list, square_plan())[0].color));
  }
}

TEST_CASE("panes at equal depth are all drawn in a fixed order, and equal panes count separately") {
  Renderer renderer(device());
  std::array<glm::vec4, 3> colors{{{0.9f, 0.1f, 0.1f, 0.5f}, {0.1f, 0.9f, 0.1f, 0.25f}, {0.1f, 0.1f, 0.9f, 0.5f}}};
  const auto picture = [&](std::span<const glm::vec4> of) {
    RendererScene scene = scene_with_ambient(1);
    for (const glm::vec4& color : of) scene.add(kPane, glass_material(color), at(0, 0, 3));
    return copy(renderer.render(scene.list, square_plan())[0].color);
  };
  const std::vector<glm::vec4> first = picture(colors);
  std::array<std::size_t, 3> order{0, 1, 2};
  int explained = 0;
  do {
    std::array<glm::vec4, 3> shuffled{colors[order[0]], colors[order[1]], colors[order[2]]};
    CHECK(same_bytes<glm::vec4>(first, picture(shuffled)));
    glm::dvec3 seen(kBackground);
    for (const glm::vec4& c : shuffled) seen = glm::dvec3(c) * double(c.a) + seen * (1.0 - c.a);
    const glm::dvec3 off = glm::abs(seen - glm::dvec3(first[0]));
    explained += std::max({off.x, off.y, off.z}) < over_rounding(3);
  } while (std::ranges::next_permutation(order).found);
  CHECK(explained == 1);
  const std::array<glm::vec4, 3> equal{colors[0], colors[0], colors[0]};
  CHECK(picture(equal)[5].r == doctest::Approx(0.9 * 0.875 + kBackground * 0.125).epsilon(over_rounding(3) * 2));
}

TEST_CASE("solid, masked and faded surfaces among panes") {
  Renderer renderer(device());
  const std::vector<Glass> panes = crossing();
  constexpr double kWall_m = 4;
  RendererScene scene = scene_of(panes);
  Material wall = colored(glm::vec4(kBackground, kBackground, kBackground, 1));
  wall.unlit = true;
  scene.add(kPane, wall, at(0, 0, kWall_m));
  const std::vector<glm::vec4> seen = copy(renderer.render(scene.list, square_plan())[0].color);
  const auto [wrong, compared] = compare(seen, panes, 1, 1, kWall_m);
  CHECK(wrong == 0);
  CHECK(compared > int(kPaneSize * kPaneSize * 9 / 10));
  CHECK(renderer.counters().layers < std::uint64_t{kPaneSize} * kPaneSize * panes.size());

  // A faded mask: its holes show the background, and the rest covers by its opacity. A masked surface hides.
  Material leaf;
  leaf.alpha_mode = AlphaMode::mask;
  leaf.alpha_cutoff = 0.3f;
  leaf.opacity = 0.75f;
  leaf.unlit = true;
  leaf.base_color_texture = four_texels();
  RendererScene faded = textured_wall(leaf);
  faded.add(kPane, glass_material({0.5f, 0.5f, 0.5f, 0.5f}), at(0, 0, 2));
  const double behind = 0.5 * 0.5 + 0.5 * kBackground;
  // The driver may decode sRGB by a table or a polynomial: an error of at most half a step of 8 bits in linear light.
  constexpr double kTexel = 0.5 / 255;
  const std::vector<glm::vec4> holes = copy(renderer.render(faded.list, wall_plan(true, false))[0].color);
  for (int column = 0; column < 4; ++column) {
    const double s = kGrey[column] / 255.0, grey = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    const double expected = kAlpha[column] / 255.0 < 0.3 ? behind : 0.75 * grey + 0.25 * behind;
    CHECK(std::abs(holes[4 + column].r - expected) < kTexel);
  }
}

TEST_CASE("views side by side have separate layers") {
  Renderer renderer(device());
  const std::vector<Glass> panes = crossing();
  FramePlan both = square_plan();
  both.passes[0].width_px = 2 * kPaneSize;
  both.passes[0].views.push_back(both.passes[0].views[0]);
  both.passes[0].views[1].x_px = kPaneSize;
  both.passes[0].views[1].view_from_world = glm::rotate(at(0.2, 0, 0), 0.05, glm::dvec3(0, 1, 0));
  const std::vector<glm::vec4> together = copy(renderer.render(scene_of(panes).list, both)[0].color);
  for (const std::uint32_t eye : {0u, 1u}) {
    std::vector<glm::vec4> seen;
    for (std::uint32_t row = 0; row < kPaneSize; ++row) {
      const auto part = std::span(together).subspan(std::size_t{row} * 2 * kPaneSize + eye * kPaneSize, kPaneSize);
      seen.insert(seen.end(), part.begin(), part.end());
    }
    std::vector<Glass> turned = panes;
    for (Glass& pane : turned) pane.place = both.passes[0].views[eye].view_from_world * pane.place;
    const auto [wrong, compared] = compare(seen, turned, 1, 1);
    CHECK(wrong == 0);
    CHECK(compared > int(kPaneSize * kPaneSize * 9 / 10));
  }
}

TEST_CASE("no layer is lost: a frame that needs more memory for layers is drawn again") {
  constexpr std::uint32_t kWidth = 320, kHeight = 256, kPanes = 6;
  Renderer renderer(device());
  RendererScene scene = scene_with_ambient(1);
  double expected = kBackground;
  for (std::uint32_t i = kPanes; i-- > 0;) {
    const float grey = 0.125f * static_cast<float>(i);
    scene.add(kPane, glass_material({grey, grey, grey, 0.25f}), at(0, 0, 2.0 + i));
    expected = expected * 0.75 + grey * 0.25;
  }
  const FramePlan plan = plan_of(kWidth, kHeight, 150, true, false);
  const std::vector<glm::vec4> first = copy(renderer.render(scene.list, plan)[0].color);
  const FrameCounters grown = renderer.counters();
  CHECK(std::ranges::all_of(first, [&](const glm::vec4& c) { return std::abs(c.r - expected) < over_rounding(6); }));
  CHECK(grown.layers == std::uint64_t{kWidth} * kHeight * kPanes);
  CHECK(grown.layer_bytes >= grown.layers * sizeof(shader::LayerNode) + std::uint64_t{kWidth} * kHeight * 4);
  CHECK(grown.passes == 4);
  CHECK(same_bytes<glm::vec4>(first, renderer.render(scene.list, plan)[0].color));
  CHECK(renderer.counters().passes == 2);
  CHECK(renderer.counters().layers == grown.layers);
}

TEST_CASE("views without visible transparency have no cost for it") {
  RendererScene plain = scene_with_ambient(1);
  plain.add(rectangle(-1, -1, 1, 1), colored({0.5f, 0.5f, 0.5f, 1}), at(0, 0, 3));
  const auto counted = [](const RendererScene& scene, const FramePlan& plan) {
    Renderer renderer(device());
    renderer.render(scene.list, plan);
    return renderer.counters();
  };
  const FramePlan color = square_plan(), depth = plan_of(kPaneSize, kPaneSize, kPaneSize / 2.0, false, true);
  CHECK(counted(plain, color).layer_bytes == 0);

  RendererScene faded = plain;  // invisible
  Material gone = glass_material({1, 1, 1, 1});
  gone.opacity = 0;
  faded.add(faded.list.items[0].mesh, faded.add_material(gone), at(0, 0, 2));
  RendererScene behind = plain;  // the camera
  behind.add(behind.list.items[0].mesh, behind.add_material(glass_material({1, 1, 1, 0.5f})), at(0, 0, -2));
  const FrameCounters alone = counted(plain, color);
  CHECK(counted(faded, color) == alone);
  FrameCounters culled = alone;  // surfaces that could come into view have their material there
  culled.items_culled += 1;
  culled.bytes_uploaded += sizeof(shader::MaterialBlock);
  CHECK(counted(behind, color) == culled);
  RendererScene pane = plain;  // in front of the camera, which takes depth
  pane.add(pane.list.items[0].mesh, pane.add_material(glass_material({1, 1, 1, 0.25f})), at(0, 0, 2));
  CHECK(counted(pane, depth) == counted(plain, depth));
}

TEST_CASE("the catalogue names the caller of the effect") {
  const EffectType* const transparency = find_effect_type("transparency");
  REQUIRE(transparency != nullptr);
  CHECK(transparency->outputs == kShownInColor);
  CHECK(transparency->in_scene(scene_of(crossing()).list));
  CHECK_FALSE(transparency->in_scene(textured_wall({}).list));
  Material faded;
  faded.opacity = 0.5f;
  CHECK(transparency->in_scene(textured_wall(faded).list));
}

TEST_SUITE_END();
